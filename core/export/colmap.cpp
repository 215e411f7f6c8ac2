#include "core/export/colmap.h"

#include <optional>
#include <utility>

#include "core/base/printf_text.h"
#include "core/export/photo_walk.h"

namespace hermite::exports {
namespace {

constexpr double kPixelCorner_px = 0.5;

}  // namespace

std::string format_colmap_cameras(const Camera& camera) {
  return "# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n" +
         printf_text("1 PINHOLE %d %d %.9g %.9g %.9g %.9g\n", camera.width, camera.height,
                     camera.fx, camera.fy, camera.cx + kPixelCorner_px,
                     camera.cy + kPixelCorner_px);
}

std::string format_colmap_images(const std::vector<ColmapImage>& images,
                                 const std::vector<std::vector<Sighting>>& tracks) {
  std::vector<std::string> points(images.size());
  for (std::size_t point = 0; point < tracks.size(); ++point)
    for (const Sighting& sighting : tracks[point])
      points[sighting.image] +=
          printf_text("%s%.2f %.2f %zu", points[sighting.image].empty() ? "" : " ",
                      static_cast<double>(sighting.u_px) + kPixelCorner_px,
                      static_cast<double>(sighting.v_px) + kPixelCorner_px, point + 1);
  std::string text =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# X Y POINT3D_ID of each point that is seen "
      "there\n";
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Rigid3 pose = inverse(images[i].world_from_camera);
    text += printf_text("%zu %.12g %.12g %.12g %.12g %.12g %.12g %.12g 1 ", i + 1,
                        pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
                        pose.translation.x(), pose.translation.y(), pose.translation.z());
    text += images[i].name + "\n" + points[i] + "\n";
  }
  return text;
}

std::string format_colmap_points(const output::Cloud& points,
                                 const std::vector<std::vector<Sighting>>& tracks) {
  std::vector<std::size_t> places;  // by image: the number of its points so far
  std::string text =
      "# POINT3D_ID X Y Z R G B ERROR, then IMAGE_ID POINT2D_INDEX of each image that sees it\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const output::CloudPoint& point = points[i];
    text += printf_text(
        "%zu %.9g %.9g %.9g %d %d %d 0", i + 1, static_cast<double>(point.position_m.x()),
        static_cast<double>(point.position_m.y()), static_cast<double>(point.position_m.z()),
        point.color.r, point.color.g, point.color.b);
    for (const Sighting& sighting : tracks[i]) {
      if (sighting.image >= places.size()) places.resize(sighting.image + 1, 0);
      text += printf_text(" %u %zu", sighting.image + 1, places[sighting.image]++);
    }
    text += "\n";
  }
  return text;
}

Result<PhotoSummary> write_colmap(const PhotoSource& source, const PhotoOptions& options,
                                  const std::string& path, const ExportProgress& progress) {
  const Camera camera = rectified(source.sequence.camera());
  std::optional<Sightings> sightings;
  std::vector<ColmapImage> images;
  const WritePhoto write_photo = [&](const archive::WholeFolder& folder,
                                     const output::Cloud& points, const SeenFrame& seen,
                                     const Photo& photo) -> Status {
    if (!sightings) sightings.emplace(points);
    sightings->look(camera, seen.world_from_camera, photo.frame.depth);
    images.push_back({photo.name, seen.world_from_camera});
    return folder.write({"images", photo.name}, photo.color_bytes);
  };
  const WriteRest write_rest = [&](const archive::WholeFolder& folder,
                                   const output::Cloud& points) -> Status {
    const std::vector<std::vector<Sighting>> tracks = sightings->tracks();
    for (const auto& [name, text] : {std::pair{"cameras.txt", format_colmap_cameras(camera)},
                                     {"images.txt", format_colmap_images(images, tracks)},
                                     {"points3D.txt", format_colmap_points(points, tracks)}})
      if (const Status status = folder.write({"sparse", "0", name}, text); !status.ok())
        return status;
    return Done{};
  };
  return PhotoWalk{source, options, path, progress}.write(write_photo, write_rest);
}

}  // namespace hermite::exports
