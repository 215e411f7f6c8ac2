// Points on a mesh, to draw it as discs. Pure function.
#pragma once

#include <cstddef>

#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite::thumbnail {

// Returns about `most` points, evenly over the area, with the colours of the texture or else of the
// vertices, the normals of the triangles, and radii that leave no gaps. A triangle has at least
// one, and of more than `most` triangles only every so many have one. Triangles without an area
// have none. CHECK: `most` is positive.
output::Cloud points_on(const output::TriangleMesh& mesh, std::size_t most);

}  // namespace hermite::thumbnail
