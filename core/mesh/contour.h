// Makes the mesh of a finished point cloud by dual contouring of its implicit surface (paper,
// section 6; Ju et al. 2002).
//
//   TriangleMesh mesh = *contour(std::move(cloud), options);
#pragma once

#include <cstddef>

#include "core/base/result.h"
#include "core/mesh/mesh_progress.h"
#include "core/mesh/surfel_field.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

struct ContourOptions {
  FieldOptions field;
  // Connected components of less area are removed: floating fragments are smaller than this.
  double least_part_m2 = 0.0025;
};

struct ContourStatistics {
  double cell_m = 0;
  std::size_t rejected_points = 0;
  std::size_t removed_parts = 0;   // smaller than least_part_m2
  std::size_t split_vertices = 0;  // vertices that were duplicated because two sheets touched there
  std::size_t folded = 0;          // triangles that were removed because they stayed folded over
};

// Returns the mesh. Uses all processors; the order of vertices and triangles does not depend on
// their number. Every edge has one or two triangles, which are oriented alike; the surface is open
// where no surfel supports it. It may be empty. kInvalidArgument as for SurfelField::create; kBusy
// when stopped.
//
// Memory: about 60 bytes per vertex of the result, for a while twice that, plus either the points
// (40 bytes each) or an index of the mesh (24 bytes per vertex). A cloud that is moved in is freed
// once it is read; one passed by reference is copied.
Result<output::TriangleMesh> contour(output::Cloud&& cloud, const ContourOptions& options,
                                     const MeshProgress& progress = {},
                                     ContourStatistics* statistics = nullptr);
Result<output::TriangleMesh> contour(const output::Cloud& cloud, const ContourOptions& options,
                                     const MeshProgress& progress = {},
                                     ContourStatistics* statistics = nullptr);

}  // namespace hermite::mesh
