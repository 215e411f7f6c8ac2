// Computes normals for a mesh without normals. Pure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Returns for each vertex the area-weighted mean of the normals of its triangles, of unit length; 0
// if no triangle has an area. Corner indices must be in range.
std::vector<Eigen::Vector3f> mean_normals(const std::vector<Eigen::Vector3f>& positions,
                                          const std::vector<TriangleCorners>& triangles);

}  // namespace hermite::output
