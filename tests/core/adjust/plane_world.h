// A room of planes alone: what a camera in it sees, to the sensor's unit.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite::adjust {

inline const Camera kPlaneCamera{320, 240, 262.5, 262.5, 159.5, 119.5, 5000};

// The points of a plane are those with plane . point = 1; the room is where it is less for all of
// them.
using PlaneRoom = std::vector<Eigen::Vector3d>;

inline PlaneRoom seen_from(const PlaneRoom& world, const Rigid3& world_from_camera) {
  PlaneRoom room;
  for (const Eigen::Vector3d& plane : world)
    room.push_back(world_from_camera.rotation.conjugate() * plane /
                   (1 - plane.dot(world_from_camera.translation)));
  return room;
}

// Farther than 6 m there is nothing.
inline DepthImage depth_of(const PlaneRoom& room_in_camera, const Camera& camera) {
  DepthImage depth(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      double inverse_m = 0;
      for (const Eigen::Vector3d& plane : room_in_camera)
        inverse_m = std::max(inverse_m, plane.dot(camera.unproject(u, v, 1)));
      if (inverse_m > 1 / 6.0)
        depth.at(u, v) =
            static_cast<std::uint16_t>(std::lround(camera.depth_units_per_metre / inverse_m));
    }
  return depth;
}

}  // namespace hermite::adjust
