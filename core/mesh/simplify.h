// Fewer triangles for the same surface: edges collapse where the surface is flat, by quadric errors
// (meshoptimizer's simplifier; Garland, Heckbert 1997, Surface simplification using quadric error
// metrics).
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "core/mesh/mesh_progress.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

struct SimplifyOptions {
  // How far the surface may move by the simplifier's own measure, 0.00001 to 1.
  double most_error_m = 0.001;
  std::int64_t least_triangles = 0;  // it stops at this many, 0 to 2^30
  // A larger mesh is first halved in passes until it has no more than this. The work can be stopped
  // between passes, but several passes leave more triangles than a single one (measured: up to a
  // third more for each pass). Two million take some seconds. At least 2.
  std::int64_t triangles_of_last_pass = 2'000'000;
};

// Returns the simplified mesh, whose vertices are vertices of `mesh` in its order. Separate parts
// of the mesh stay separate, and no edge gets more than two triangles. To be called before a mesh
// is textured, because the colours of removed vertices are lost. `progress` is called before each
// pass. Deterministic and pure. kInvalidArgument for options, and for a mesh with a texture or with
// a triangle whose vertex is missing; kBusy when stopped by `progress`.
Result<output::TriangleMesh> simplified(const output::TriangleMesh& mesh,
                                        const SimplifyOptions& options,
                                        const MeshProgress& progress = {});

}  // namespace hermite::mesh
