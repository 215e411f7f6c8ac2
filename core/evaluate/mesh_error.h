// How far a mesh is from the true surface that a sequence has seen. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "core/evaluate/seen_truth.h"
#include "core/evaluate/surface_error.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite {

// This near to a crease of the truth a point counts as one of its edge.
inline constexpr double kCreaseWidth_m = 0.02;

struct FScore {
  double within_m = 0;
  double precision = 0;  // share of the points of the mesh that are so near to the truth
  double recall = 0;     // share of the truth's samples that are so near to the mesh
  double f() const { return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0; }
};

struct MeshError {
  SurfaceError surface;                 // of points spread evenly over the mesh; each distance at most kSurfaceReach_m
  std::optional<SurfaceError> creases;  // of those within kCreaseWidth_m of a crease; none where the truth has none there
  FScore at_5mm, at_10mm;               //
  double missing_at_creases = 0;        // share of the truth's samples so near to a crease that are farther than 10 mm from the mesh
  double depth_mean_m = 0;              // of the absolute differences of depth over all pixels that both have
  double depth_capped_mean_m = 0;       // the same, each at most kSurfaceReach_m: silhouettes count less
  double depth_median_m = 0;            //
  double depth_missing = 0;             // share of the truth's pixels that the mesh has not
  std::int64_t views = 0;
};

// `count` points, evenly over the area: triangles get them by their share of it, in their order. None without area. Triangles that are not
// finite are left out. Deterministic.
std::vector<Eigen::Vector3d> points_on(const std::vector<Triangle>& triangles, std::size_t count);

// Of a mesh, or of the points of a cloud as triangles without extent, which are judged as they are and draw no depth.
// kInvalidArgument: nothing to judge, or a point that is not finite.
Result<MeshError> mesh_error(const std::vector<Triangle>& triangles_in_world, const SeenTruth& truth);

std::string format_mesh_error_json(const MeshError& error);

}  // namespace hermite
