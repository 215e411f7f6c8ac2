#include "core/export/nerfstudio.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/export/photo_walk.h"
#include "core/image/image_codec.h"
#include "core/output/ply.h"

namespace hermite::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMmPerMetre_nerf = 1000, kMostMm = 65535;

// Returns the pose with the axes rotated by half a turn about x: y up, looking along -z.
Json opengl_matrix(const Rigid3& world_from_camera) {
  Eigen::Matrix4d matrix = world_from_camera.matrix();
  matrix.col(1) *= -1;
  matrix.col(2) *= -1;
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  return rows;
}

DepthImage in_millimetres(const DepthImage& depth, double depth_units_per_metre) {
  DepthImage result(depth.width, depth.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    const double mm = std::round(depth.pixels[i] * kMmPerMetre_nerf / depth_units_per_metre);
    result.pixels[i] = mm <= kMostMm ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};
  }
  return result;
}

}  // namespace

std::string format_transforms_json(const Camera& camera,
                                   const std::vector<NerfstudioImage>& images) {
  Json json{{"camera_model", "PINHOLE"}, {"w", camera.width},
            {"h", camera.height},        {"fl_x", camera.fx},
            {"fl_y", camera.fy},         {"cx", camera.cx + 0.5},
            {"cy", camera.cy + 0.5},     {"ply_file_path", "points.ply"}};
  json["frames"] = Json::array();
  for (const NerfstudioImage& image : images)
    json["frames"].push_back({{"file_path", "images/" + image.name},
                              {"depth_file_path", "depth/" + image.depth_name},
                              {"transform_matrix", opengl_matrix(image.world_from_camera)}});
  return json.dump(2) + "\n";
}

Result<PhotoSummary> write_nerfstudio(const PhotoSource& source, const PhotoOptions& options,
                                      const std::string& path, const ExportProgress& progress) {
  const Camera camera = rectified(source.sequence.camera());
  std::vector<NerfstudioImage> images;
  const WritePhoto write_photo = [&](const archive::WholeFolder& folder, const output::Cloud&,
                                     const SeenFrame& seen, const Photo& photo) -> Status {
    const std::string depth_name = photo.name.substr(0, photo.name.find('.')) + ".png";
    const auto depth =
        image::encode_depth_png(in_millimetres(photo.frame.depth, camera.depth_units_per_metre));
    if (!depth.ok()) return depth.error();
    images.push_back({photo.name, depth_name, seen.world_from_camera});
    if (const Status status = folder.write({"depth", depth_name}, *depth); !status.ok())
      return status;
    return folder.write({"images", photo.name}, photo.color_bytes);
  };
  const WriteRest write_rest = [&](const archive::WholeFolder& folder,
                                   const output::Cloud& points) -> Status {
    if (const Status status = folder.write({"points.ply"}, output::format_ply(points));
        !status.ok())
      return status;
    return folder.write({"transforms.json"}, format_transforms_json(camera, images));
  };
  return PhotoWalk{source, options, path, progress}.write(write_photo, write_rest);
}

}  // namespace hermite::exports
