// Fewer triangles for the same surface: edges collapse where the surface is flat, by quadric errors (meshoptimizer's simplifier; Garland,
// Heckbert 1997, Surface simplification using quadric error metrics).
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

struct SimplifyOptions {
  double most_error_m = 0.001;       // how far the surface may move by the simplifier's own measure, 0.00001 to 1
  std::int64_t least_triangles = 0;  // it stops at this many, 0 to 2^30
};

// Vertices of the result are vertices of `mesh`, in its order; parts stay parts, and no edge gets more than two triangles. Before a mesh is
// textured: colours of vertices that go are lost. Deterministic, pure. kInvalidArgument: options, or a mesh with a texture or a triangle
// without its vertex.
Result<TriangleMesh> simplified(const TriangleMesh& mesh, const SimplifyOptions& options);

}  // namespace hermite
