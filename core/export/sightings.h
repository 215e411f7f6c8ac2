// In which pictures a point of the cloud is seen, and where: the tracks that photogrammetry finds by features, known here from depth.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/output/cloud.h"

namespace hermite {

struct Sighting {
  std::uint32_t picture = 0;  // in the order of the calls of look()
  float u_px = 0, v_px = 0;   // pixel centres are integers
};

// One thread. Memory: at most 2 kMostSightings for a point.
class Sightings {
 public:
  // Of a point: of more, every second, fourth, ... is kept, so that they stay spread over the scan.
  static constexpr std::size_t kMostSightings = 12;

  // `cloud` must stay.
  explicit Sightings(const Cloud& cloud) : cloud_(cloud), tracks_(cloud.size()) {}

  // A point is seen where it falls into the picture, faces the camera, and the depth measured there is its own within 2 % and 2 cm.
  // `camera` is rectified, `depth` of its size.
  void look(const Camera& camera, const Rigid3& world_from_camera, const DepthImage& depth);

  // By point, pictures ascending; at most kMostSightings.
  std::vector<std::vector<Sighting>> tracks() const;

 private:
  struct Track {
    std::vector<Sighting> kept;
    std::uint32_t seen = 0, step = 1;  // every `step`-th is kept
  };
  const Cloud& cloud_;
  std::vector<Track> tracks_;
  std::uint32_t picture_count_ = 0;
};

}  // namespace hermite
