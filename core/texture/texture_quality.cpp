#include "core/texture/texture_quality.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/output/mesh_check.h"
#include "core/texture/view_alignment.h"
#include "core/texture/view_raster.h"
#include "core/texture/view_selection.h"
#include "core/texture/view_warp.h"

namespace hermite::texture {

namespace {

using Eigen::Vector3f;

constexpr double kNoDifference_db = 99;

Vector3f vector_of(const Rgb8& pixel) {
  return {static_cast<float>(pixel.r), static_cast<float>(pixel.g), static_cast<float>(pixel.b)};
}

Rgb8 pixel_of(const Vector3f& color) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
  };
  return {byte(color.x()), byte(color.y()), byte(color.z())};
}

Vector3f between_texels(const ColorImage& image, const Eigen::Vector2f& coordinates) {
  const float u = std::clamp(coordinates.x() * static_cast<float>(image.width) - 0.5f, 0.0f,
                             static_cast<float>(image.width - 1));
  const float v = std::clamp(coordinates.y() * static_cast<float>(image.height) - 0.5f, 0.0f,
                             static_cast<float>(image.height - 1));
  const int x = static_cast<int>(u), y = static_cast<int>(v),
            right = std::min(x + 1, image.width - 1), below = std::min(y + 1, image.height - 1);
  const float dx = u - static_cast<float>(x), dy = v - static_cast<float>(y);
  return (1 - dy) * ((1 - dx) * vector_of(image.at(x, y)) + dx * vector_of(image.at(right, y))) +
         dy * ((1 - dx) * vector_of(image.at(x, below)) + dx * vector_of(image.at(right, below)));
}

const output::TexturePage& page_of(const output::TriangleMesh& mesh, std::uint32_t triangle) {
  const auto behind = std::upper_bound(
      mesh.pages.begin(), mesh.pages.end(), triangle,
      [](std::uint32_t t, const output::TexturePage& page) { return t < page.first_triangle; });
  return *(behind - 1);
}

Vector3f color_of(const output::TriangleMesh& mesh, std::uint32_t triangle, const Vector3f& weights,
                  MeshColor color) {
  const output::TriangleCorners& t = mesh.triangles[triangle];
  if (color == MeshColor::kVertices)
    return weights[0] * vector_of(mesh.colors[t[0]]) + weights[1] * vector_of(mesh.colors[t[1]]) +
           weights[2] * vector_of(mesh.colors[t[2]]);
  return between_texels(page_of(mesh, triangle).image,
                        weights[0] * mesh.texture_coordinates[t[0]] +
                            weights[1] * mesh.texture_coordinates[t[1]] +
                            weights[2] * mesh.texture_coordinates[t[2]]);
}

// Returns, by channel, the factor that fits the rendered image to the frame best.
Vector3f best_gain(const MeshRendering& rendering, const ColorImage& image) {
  Vector3f products = Vector3f::Zero(), squares = Vector3f::Constant(1e-6f);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (rendering.is_covered.pixels[i] == 0) continue;
    const Vector3f drawn_color = vector_of(rendering.color.pixels[i]) / 255,
                   there = vector_of(image.pixels[i]) / 255;
    products += drawn_color.cwiseProduct(there);
    squares += drawn_color.cwiseProduct(drawn_color);
  }
  return products.cwiseQuotient(squares);
}

MeshRendering times(MeshRendering rendering, const Vector3f& gain) {
  for (Rgb8& pixel : rendering.color.pixels) pixel = pixel_of(vector_of(pixel).cwiseProduct(gain));
  return rendering;
}

MeshRendering seen_rendering(const output::TriangleMesh& mesh, const TextureFrames& frames,
                             const Rigid3& world_from_camera, MeshColor color) {
  MeshRendering rendering = drawn(mesh, frames.camera, world_from_camera, color);
  for (std::size_t i = 0; i < frames.is_seen.pixels.size(); ++i)
    if (frames.is_seen.pixels[i] == 0) rendering.is_covered.pixels[i] = 0;
  return rendering;
}

// Evaluates a frame at its present pose. Also scales the view's corrected colours to the brightness
// of the texture, for a later alignment.
HeldOutFrame judged(const output::TriangleMesh& mesh, const TextureFrames& frames,
                    TextureView& view) {
  HeldOutFrame held_out;
  held_out.frame = view.frame;
  const MeshRendering texture =
      seen_rendering(mesh, frames, view.world_from_camera, MeshColor::kTexture);
  const MeshRendering vertices =
      seen_rendering(mesh, frames, view.world_from_camera, MeshColor::kVertices);
  const auto covered = std::count(texture.is_covered.pixels.begin(),
                                  texture.is_covered.pixels.end(), std::uint8_t{1});
  held_out.covered_share =
      static_cast<double>(covered) / static_cast<double>(texture.is_covered.pixels.size());
  const Vector3f gain = best_gain(texture, view.color).cwiseMax(0.1f);
  held_out.texture_db = psnr_db(texture, view.color);
  held_out.vertices_db = psnr_db(vertices, view.color);
  held_out.texture_gain_db = psnr_db(times(texture, gain), view.color);
  held_out.vertices_gain_db = psnr_db(times(vertices, best_gain(vertices, view.color)), view.color);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t value = 0; value < 256; ++value)
      view.corrected[channel][value] =
          static_cast<float>(value) / gain[static_cast<Eigen::Index>(channel)];
  return held_out;
}

double warped_db(const output::TriangleMesh& mesh, const TextureFrames& frames,
                 const TextureView& view) {
  const MeshRendering rendering =
      seen_rendering(mesh, frames, view.world_from_camera, MeshColor::kTexture);
  TextureView plain = view;
  set_gain(plain, Vector3f::Ones());
  ColorImage bent(view.color.width, view.color.height);
  for (int y = 0; y < bent.height; ++y)
    for (int x = 0; x < bent.width; ++x)
      bent.at(x, y) = pixel_of(color_at(plain, static_cast<float>(x), static_cast<float>(y)));
  return psnr_db(times(rendering, best_gain(rendering, bent)), bent);
}

double aligned_db(const output::TriangleMesh& mesh, const TextureFrames& frames,
                  const TextureView& view) {
  const MeshRendering rendering =
      seen_rendering(mesh, frames, view.world_from_camera, MeshColor::kTexture);
  return psnr_db(times(rendering, best_gain(rendering, view.color)), view.color);
}

void add_means(HeldOutQuality& quality) {
  const auto count = static_cast<double>(quality.frames.size());
  for (const HeldOutFrame& frame : quality.frames) {
    quality.texture_db += frame.texture_db / count;
    quality.vertices_db += frame.vertices_db / count;
    quality.texture_gain_db += frame.texture_gain_db / count;
    quality.vertices_gain_db += frame.vertices_gain_db / count;
    quality.texture_aligned_db += frame.texture_aligned_db / count;
    quality.texture_warped_db += frame.texture_warped_db / count;
  }
}

}  // namespace

MeshRendering drawn(const output::TriangleMesh& mesh, const Camera& camera,
                    const Rigid3& world_from_camera, MeshColor color) {
  const ViewRaster raster = rasterised(mesh, camera, world_from_camera);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  MeshRendering rendering{ColorImage(camera.width, camera.height),
                          Image<std::uint8_t>(camera.width, camera.height)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::uint32_t triangle = raster.triangle.at(x, y);
      if (triangle == kNoTriangle) continue;
      const Vector3f weights =
          weights_in_triangle(mesh, triangle, camera_from_world, camera.unproject(x, y, 1));
      rendering.color.at(x, y) = pixel_of(color_of(mesh, triangle, weights, color));
      rendering.is_covered.at(x, y) = 1;
    }
  return rendering;
}

double psnr_db(const MeshRendering& rendering, const ColorImage& image) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (rendering.is_covered.pixels[i] == 0) continue;
    sum += static_cast<double>(
        (vector_of(rendering.color.pixels[i]) - vector_of(image.pixels[i])).squaredNorm());
    count += 3;
  }
  if (count == 0 || sum == 0) return kNoDifference_db;
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum);
}

Result<HeldOutQuality> held_out_quality(const output::TriangleMesh& mesh,
                                        const TextureFrames& frames, const TextureOptions& options,
                                        output::TriangleMesh* result,
                                        TextureStatistics* statistics) {
  for (const Status& status :
       {validate(options), validate(frames), output::check_mesh_with_triangles(mesh)})
    if (!status.ok()) return status.error();
  const std::vector<std::size_t> selected = selected_views(mesh, frames, options);
  std::vector<std::size_t> used, left_out;
  for (std::size_t i = 0; i < selected.size(); ++i)
    (i % kHeldOutOf == kHeldOutOf / 2 ? left_out : used).push_back(selected[i]);
  if (left_out.empty() || used.empty())
    return Error{
        ErrorCode::kNotFound,
        fmt::format("of {} views none can be left out: eight are needed", selected.size())};
  TextureStatistics counted;
  const TextureProgress nobody;
  const TextureRun run{options, nobody, counted};
  Result<std::vector<TextureView>> views = agreed_views(mesh, frames, used, run);
  if (!views.ok()) return views.error();
  Result<output::TriangleMesh> textured_mesh = painted(mesh, frames.camera, *views, run);
  if (!textured_mesh.ok()) return textured_mesh.error();
  HeldOutQuality quality;
  for (const std::size_t frame : left_out) {
    Result<TextureView> view = load_view(mesh, frames, frame);
    if (!view.ok()) continue;
    const HeldOutFrame held_out = judged(*textured_mesh, frames, *view);
    if (held_out.covered_share == 0) continue;
    quality.frames.push_back(held_out);
    views->push_back(*std::move(view));
  }
  if (quality.frames.empty())
    return Error{ErrorCode::kNotFound, "none of the frames left out can be read and sees the mesh"};
  align_views(mesh, frames, options, *views, quality.frames.size());
  warp_views(mesh, frames, options, *views, quality.frames.size());
  for (std::size_t i = 0; i < quality.frames.size(); ++i) {
    const TextureView& view = (*views)[views->size() - quality.frames.size() + i];
    quality.frames[i].texture_aligned_db = aligned_db(*textured_mesh, frames, view);
    quality.frames[i].texture_warped_db = warped_db(*textured_mesh, frames, view);
    quality.frames[i].aligned_world_from_camera = view.world_from_camera;
  }
  add_means(quality);
  if (result) *result = *std::move(textured_mesh);
  if (statistics) *statistics = counted;
  return quality;
}

}  // namespace hermite::texture
