// Normals for a mesh that has none. Pure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite {

// By vertex the mean of those of the triangles around it, by area, unit; 0 where there is no triangle with an area. Corners are of
// positions that are there.
std::vector<Eigen::Vector3f> mean_normals(const std::vector<Eigen::Vector3f>& positions, const std::vector<TriangleCorners>& triangles);

}  // namespace hermite
