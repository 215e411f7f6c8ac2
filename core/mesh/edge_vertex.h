// The point where the planes of a piece of surface meet: the vertex of dual contouring (Ju,
// Losasso, Schaefer, Warren 2002, section 2.3).
#pragma once

#include <Eigen/Core>
#include <span>

namespace hermite::mesh {

struct SurfacePlane {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit
};

struct EdgeVertex {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  int rank = 0;  // 1: the planes are one surface, 2: they meet in an edge, 3: in a corner
};

// Returns the point with the least sum of squared distances to the planes; if there are several,
// the one nearest to the centroid of their points. Directions that the planes hardly constrain are
// left free. The result is not clamped. CHECK: there is at least one plane.
EdgeVertex meet(std::span<const SurfacePlane> planes);

}  // namespace hermite::mesh
