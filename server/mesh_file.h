// What `hermite mesh` and `hermite reconstruct --mesh` have in common: a mesh is made of a file of points, and written. Failures are
// SetupErrors.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/contour.h"
#include "core/mesh/hole_fill.h"

namespace hermite {

struct MeshMaking {
  ContourOptions contour;
  double simplify_mm = 0;      // 0: not at all
  std::int64_t triangles = 0;  // with that: not fewer than these
  HoleFillOptions holes;
};

// Of a result folder what meshes are made of, or at least its cloud; of a file that.
std::string mesh_source_path(const std::string& result);

// Reads points with normals from a PLY and writes their mesh as one, whole or not at all. Gives back what came of it, for people and
// programs: counts, areas and seconds.
nlohmann::ordered_json make_mesh_file(const std::string& points_path, const MeshMaking& making, const std::string& mesh_path);

}  // namespace hermite
