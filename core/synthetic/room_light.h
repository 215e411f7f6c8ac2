// Light in a synthetic scene: for each zone a lamp under the ceiling, a window and the ambient
// light of the walls, darker in corners. Independent of the viewer.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/synthetic/room_furniture.h"

namespace hermite::synthetic {

// Returns the distance to the union of all bodies, positive in free space. It is exact there, and
// inside up to the depth of the deepest body around the point.
double signed_distance(const Furniture& furniture, const Eigen::Vector3d& point_in_world);

// Immutable after construction; thread-safe.
class RoomLight {
 public:
  explicit RoomLight(const Furniture& furniture);

  // Returns the light at a surface point with this unit normal, linear RGB; about 1 on a bright
  // wall.
  Eigen::Vector3f at(const Eigen::Vector3d& point_in_world,
                     const Eigen::Vector3d& normal_in_world) const;

 private:
  void fill_block(const Furniture& furniture, int x0, int y0, int z0);
  Eigen::Vector3f grid_point(int x, int y, int z) const;
  float clearance_m(const Eigen::Vector3f& point_in_world) const;
  Eigen::Vector3f zones_light(const Eigen::Vector3f& point_in_world,
                              const Eigen::Vector3f& normal_in_world) const;

  const std::vector<LightZone> zones_;
  Eigen::Vector3f low_m_ = Eigen::Vector3f::Zero();  // of the grid
  int size_x_ = 0, size_y_ = 0, size_z_ = 0;
  // Distance to the nearest surface at grid points, x fastest.
  std::vector<float> clearance_grid_m_;
};

// Returns 8-bit sRGB, clamped.
Rgb8 srgb_from_linear(const Eigen::Vector3f& linear);

}  // namespace hermite::synthetic
