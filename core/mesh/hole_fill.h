// Holes of a mesh filled with triangles that nobody has seen, each within its own border (Liepa 2003, Filling holes in meshes).
#pragma once

#include <cstddef>

#include "core/base/result.h"
#include "core/mesh/mesh_progress.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

inline constexpr double kMostHoleWidth_m = 10;

struct HoleFillOptions {
  double width_m = 0;       // of the widest holes that are filled, 0 to kMostHoleWidth_m; no two points of its border are farther apart
  bool closes_all = false;  // what is wider, and where the surface ends, too, so that it encloses a volume
};

struct HoleFillStatistics {
  std::size_t filled = 0, closed = 0;  // no wider than width_m; all others, with closes_all
  std::size_t left_open = 0;           // wider, or where a piece of surface ends
  std::size_t not_fillable = 0;        // borders that touch themselves, or whose filling would fold over
  double filled_area_m2 = 0, closed_area_m2 = 0;
};

// The mesh with triangles added behind its own, marked in is_filled; vertices that are added have the colours of the border, spread. What
// is no wider than width_m goes on as bent as the surface around it; what is closed beyond that is stretched across its border, and normals
// of that border may change. Edges keep at most two triangles, which are oriented alike, and none of those of `filled` is folded. A filling
// may pass through other pieces of surface. Holes are filled one by one: two borders are never joined. The same bytes for any number of
// threads.
//
// kInvalidArgument: width_m, a mesh with a texture or marks, or what check_mesh refuses; kBusy: stopped.
Result<TriangleMesh> holes_filled(const TriangleMesh& mesh, const HoleFillOptions& options, const MeshProgress& progress = {},
                                  HoleFillStatistics* statistics = nullptr);

}  // namespace hermite
