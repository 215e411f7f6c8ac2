#include "core/export/sightings.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hermite::exports {
namespace {

constexpr double kSameDepth_m = 0.02, kSameDepthShare = 0.02;
constexpr double kNearest_m = 0.05;

std::optional<Sighting> sighting_of(const output::CloudPoint& point, const Camera& camera,
                                    const Rigid3& camera_from_world, const DepthImage& depth) {
  const Eigen::Vector3d at = camera_from_world * point.position_m.cast<double>();
  if (!(at.z() > kNearest_m) ||
      (camera_from_world.rotation * point.normal.cast<double>()).dot(at) > 0)
    return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(at);
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= camera.width - 1 &&
        pixel.y() <= camera.height - 1))
    return std::nullopt;
  const double measured_m =
      depth.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))) /
      camera.depth_units_per_metre;
  if (std::abs(measured_m - at.z()) > std::max(kSameDepth_m, kSameDepthShare * at.z()))
    return std::nullopt;
  return Sighting{0, static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

void keep_every_second(std::vector<Sighting>& sightings) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sightings.size(); i += 2) sightings[count++] = sightings[i];
  sightings.resize(count);
}

}  // namespace

void Sightings::look(const Camera& camera, const Rigid3& world_from_camera,
                     const DepthImage& depth) {
  const Rigid3 camera_from_world = inverse(world_from_camera);
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    std::optional<Sighting> sighting = sighting_of(cloud_[i], camera, camera_from_world, depth);
    if (!sighting) continue;
    sighting->image = image_count_;
    Track& track = tracks_[i];
    if (track.seen++ % track.step != 0) continue;
    track.kept.push_back(*sighting);
    if (track.kept.size() < 2 * kMostSightings) continue;
    keep_every_second(track.kept);
    track.step *= 2;
  }
  ++image_count_;
}

std::vector<std::vector<Sighting>> Sightings::tracks() const {
  std::vector<std::vector<Sighting>> tracks;
  for (const Track& track : tracks_) {
    tracks.push_back(track.kept);
    if (tracks.back().size() > kMostSightings) keep_every_second(tracks.back());
  }
  return tracks;
}

}  // namespace hermite::exports
