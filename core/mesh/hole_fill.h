// Fills holes of a mesh with triangles that were not measured, each hole within its own boundary
// (Liepa 2003, Filling holes in meshes).
#pragma once

#include <cstddef>

#include "core/base/result.h"
#include "core/mesh/mesh_progress.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

inline constexpr double kMostHoleWidth_m = 10;

struct HoleFillOptions {
  // Holes up to this width are filled, 0 to kMostHoleWidth_m: the largest distance on a boundary.
  double width_m = 0;
  // Close wider holes and outer boundaries as well, so that the mesh encloses a volume.
  bool closes_all = false;
};

struct HoleFillStatistics {
  std::size_t filled = 0, closed = 0;  // holes up to width_m; all other boundaries, with closes_all
  std::size_t left_open = 0;           // wider holes, and outer boundaries
  // Boundaries that touch themselves, or whose filling would fold over.
  std::size_t not_fillable = 0;
  double filled_area_m2 = 0, closed_area_m2 = 0;
};

// Returns the mesh with new triangles appended and marked in is_filled; new vertices have colours
// interpolated from the boundary. Holes up to width_m continue the curvature of the surface around
// them; wider holes and outer boundaries that are closed get a minimal surface across the boundary,
// whose normals may change. Edges keep at most two triangles, which are oriented alike, and no
// filled hole folds over. A filling may pass through other pieces of surface. Each boundary is
// filled by itself; two are never joined. The result does not depend on the number of threads.
//
// kInvalidArgument for width_m, for a mesh with a texture or marks, and for what check_mesh
// rejects; kBusy when stopped.
Result<output::TriangleMesh> holes_filled(const output::TriangleMesh& mesh,
                                          const HoleFillOptions& options,
                                          const MeshProgress& progress = {},
                                          HoleFillStatistics* statistics = nullptr);

}  // namespace hermite::mesh
