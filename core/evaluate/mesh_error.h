// Measures how far a mesh is from the true surface that a sequence has seen. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "core/evaluate/seen_truth.h"
#include "core/evaluate/surface_error.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite::evaluate {

// A point this close to a crease of the truth belongs to its edge.
inline constexpr double kCreaseWidth_m = 0.02;

struct FScore {
  double within_m = 0;
  double precision = 0;  // share of the mesh's points that are this close to the truth
  double recall = 0;     // share of the truth's samples that are this close to the mesh
  double f() const {
    return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
  }
};

struct MeshError {
  // Error of points spread evenly over the mesh; each distance is at most kSurfaceReach_m.
  SurfaceError surface;
  // Error of those within kCreaseWidth_m of a crease; nullopt if there are none.
  std::optional<SurfaceError> creases;
  FScore at_5mm, at_10mm;
  // Share of the truth's samples this close to a crease that are more than 10 mm from the mesh.
  double missing_at_creases = 0;
  // Mean of the absolute differences of depth over all pixels that both cover.
  double depth_mean_m = 0;
  // The same with each difference at most kSurfaceReach_m, so that silhouettes have less weight.
  double depth_capped_mean_m = 0;
  double depth_median_m = 0;
  double depth_missing = 0;  // share of the truth's pixels that the mesh does not cover
  std::int64_t views = 0;
};

// Returns `count` points that are spread evenly over the area, in the order of the triangles; none
// if there is no area. Triangles that are not finite are ignored. Deterministic.
std::vector<Eigen::Vector3d> points_on(const std::vector<Triangle>& triangles, std::size_t count);

// Judges a mesh, or the points of a cloud as triangles without extent, which are used as they are
// and draw no depth. kInvalidArgument when there is nothing to judge, or a point is not finite.
Result<MeshError> mesh_error(const std::vector<Triangle>& triangles_in_world,
                             const SeenTruth& truth, std::size_t point_count = 400'000);

std::string format_mesh_error_json(const MeshError& error);

}  // namespace hermite::evaluate
