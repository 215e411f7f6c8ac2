// A mesh of a finished cloud: dual contouring of its implicit surface (paper, section 6; Ju et al. 2002).
//
//   TriangleMesh mesh = *contour(std::move(cloud), options);
#pragma once

#include <cstddef>

#include "core/base/result.h"
#include "core/mesh/mesh_progress.h"
#include "core/mesh/surfel_field.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

struct ContourOptions {
  FieldOptions field;
  double least_part_m2 = 0.0025;  // connected pieces of less surface are left out: what floats is no bigger than a hand's breadth squared
};

struct ContourStatistics {
  double cell_m = 0;
  std::size_t rejected_points = 0;
  std::size_t removed_parts = 0;   // smaller than least_part_m2
  std::size_t split_vertices = 0;  // at which two sheets touched
  std::size_t folded = 0;          // triangles that were left out because they could not be laid flat
};

// On all processors, in the same order of vertices and triangles whatever their number. Every edge has one or two triangles, which are
// oriented alike; what nothing supports is open. May be empty of triangles. kInvalidArgument as of SurfelField::create; kBusy: stopped.
//
// Memory: what is made, some 60 bytes a vertex, twice for a while, beside either the points (40 bytes each, gone before the end) or an
// index of the mesh (24 bytes a vertex). A cloud that is handed over is gone once it is read; of one that is not a copy is made.
Result<TriangleMesh> contour(Cloud&& cloud, const ContourOptions& options, const MeshProgress& progress = {},
                             ContourStatistics* statistics = nullptr);
Result<TriangleMesh> contour(const Cloud& cloud, const ContourOptions& options, const MeshProgress& progress = {},
                             ContourStatistics* statistics = nullptr);

}  // namespace hermite
