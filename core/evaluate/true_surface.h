// The reference for a reconstruction: the depth of a sequence at its true poses, the formulas of
// the synthetic room, or a mesh.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/evaluate/surface_error.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite::evaluate {

// Distances are capped at this: farther points do not belong to this surface and must not dominate
// a mean.
inline constexpr double kSurfaceReach_m = 0.1;

struct TrueSurface {
  // Distance of a point of the true world, at most kSurfaceReach_m.
  std::function<double(const Eigen::Vector3d&)> distance_m;
  std::vector<Eigen::Vector3d> samples;  // points spread over the surface
};

TrueSurface surface_of_triangles(const std::vector<Triangle>& triangles);

// Uses up to 24 frames spread over the sequence, at the poses of its ground truth; distances in the
// synthetic room are exact. kNotFound without ground truth.
Result<TrueSurface> surface_of_sequence(const dataset::Sequence& sequence,
                                        const std::string& source);

// Returns the share of the samples that have a point of the cloud within `within_m`, 0 to 1; 0
// without samples.
double completeness(const TrueSurface& surface, const TriangleSurface& cloud_in_world,
                    double within_m);

}  // namespace hermite::evaluate
