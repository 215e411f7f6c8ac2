// Finds the images in which a point of the cloud is visible: the tracks that photogrammetry gets
// from features follow from depth here.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/output/cloud.h"

namespace hermite::exports {

struct Sighting {
  std::uint32_t image = 0;   // in the order of the calls of look()
  float u_px = 0, v_px = 0;  // pixel centres are integers
};

// One thread. Memory: at most 2 kMostSightings per point.
class Sightings {
 public:
  // The limit per point. When it is exceeded, every second, fourth, ... sighting is kept, so that
  // they stay spread over the scan.
  static constexpr std::size_t kMostSightings = 12;

  // `cloud` must outlive this object.
  explicit Sightings(const output::Cloud& cloud) : cloud_(cloud), tracks_(cloud.size()) {}

  // Adds an image. A point is visible in it if its projection is inside, it faces the camera, and
  // the measured depth is its own within 2 % and 2 cm. `camera` is rectified, `depth` has its size.
  void look(const Camera& camera, const Rigid3& world_from_camera, const DepthImage& depth);

  // Returns at most kMostSightings by point, in ascending order of images.
  std::vector<std::vector<Sighting>> tracks() const;

 private:
  struct Track {
    std::vector<Sighting> kept;
    std::uint32_t seen = 0, step = 1;  // every `step`-th sighting is kept
  };
  const output::Cloud& cloud_;
  std::vector<Track> tracks_;
  std::uint32_t image_count_ = 0;
};

}  // namespace hermite::exports
