#include "server/evaluate_texture.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/dataset/trajectory.h"
#include "core/export/texture_frames.h"
#include "core/image/image_codec.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"
#include "core/texture/texture_quality.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

void write_png(const std::string& path, const ColorImage& image) {
  const std::vector<std::uint8_t> bytes = or_throw(image::encode_png(image));
  or_throw(output::write_file_atomically(path, std::string(bytes.begin(), bytes.end())));
}

// Places the frame above renderings of the mesh with its texture and with its vertex colours.
ColorImage beside_each_other(const ColorImage& frame, const ColorImage& textured,
                             const ColorImage& vertices) {
  ColorImage all(frame.width, 3 * frame.height);
  auto at = std::copy(frame.pixels.begin(), frame.pixels.end(), all.pixels.begin());
  at = std::copy(textured.pixels.begin(), textured.pixels.end(), at);
  std::copy(vertices.pixels.begin(), vertices.pixels.end(), at);
  return all;
}

void write_images(const std::string& folder, const output::TriangleMesh& mesh,
                  const texture::TextureFrames& frames, const texture::HeldOutQuality& quality) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < mesh.pages.size(); ++i)
    write_png(fmt::format("{}/page-{}.png", folder, i), mesh.pages[i].image);
  for (const texture::HeldOutFrame& held_out : quality.frames) {
    const Rigid3& pose = *frames.world_from_camera[held_out.frame];
    write_png(fmt::format("{}/frame-{}.png", folder, held_out.frame),
              beside_each_other(
                  or_throw(frames.read(held_out.frame)),
                  texture::drawn(mesh, frames.camera, held_out.aligned_world_from_camera,
                                 texture::MeshColor::kTexture)
                      .color,
                  texture::drawn(mesh, frames.camera, pose, texture::MeshColor::kVertices).color));
  }
}

}  // namespace

Json evaluate_texture(const TextureJudging& judging) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(judging.recording));
  const texture::TextureFrames frames = exports::texture_frames_of(
      *sequence, or_throw(dataset::read_tum_trajectory(judging.trajectory)));
  texture::TextureOptions options;
  options.texel_m = judging.texel_mm / 1000;
  options.max_views = judging.max_views;
  options.blended_views = judging.blended_views;
  options.solves_exposure = !judging.keeps_exposure;
  options.refines_poses = !judging.keeps_poses;
  const output::TriangleMesh mesh = or_throw(output::mesh_of(read_ply_file(judging.mesh)));
  output::TriangleMesh textured_mesh;
  texture::TextureStatistics statistics;
  const auto start = std::chrono::steady_clock::now();
  const texture::HeldOutQuality quality =
      or_throw(texture::held_out_quality(mesh, frames, options, &textured_mesh, &statistics));
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!judging.images.empty()) write_images(judging.images, textured_mesh, frames, quality);
  Json by_frame = Json::array();
  for (const texture::HeldOutFrame& frame : quality.frames)
    by_frame.push_back({{"frame", frame.frame},
                        {"covered", frame.covered_share},
                        {"texture_db", frame.texture_db},
                        {"vertices_db", frame.vertices_db},
                        {"texture_gain_db", frame.texture_gain_db},
                        {"texture_aligned_db", frame.texture_aligned_db},
                        {"texture_warped_db", frame.texture_warped_db}});
  return {{"texture_held_out_frames", quality.frames.size()},
          {"texture_psnr_db", quality.texture_db},
          {"vertices_psnr_db", quality.vertices_db},
          {"texture_gain_fitted_psnr_db", quality.texture_gain_db},
          {"texture_pose_and_gain_fitted_psnr_db", quality.texture_aligned_db},
          {"texture_pose_warp_and_gain_fitted_psnr_db", quality.texture_warped_db},
          {"vertices_gain_fitted_psnr_db", quality.vertices_gain_db},
          {"texture_views", statistics.views},
          {"texture_views_moved", statistics.moved_views},
          {"texture_disagreement_before", statistics.disagreement_before},
          {"texture_disagreement_after", statistics.disagreement_after},
          {"texture_charts", statistics.charts},
          {"texture_texel_m", statistics.texel_m},
          {"texture_filled_share", statistics.filled_share},
          {"texture_pages", textured_mesh.pages.size()},
          {"texture_vertices", textured_mesh.positions_m.size()},
          {"texture_seconds", seconds},
          {"texture_by_frame", by_frame}};
}

}  // namespace hermite::commands
