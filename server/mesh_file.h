// What `hermite mesh` and `hermite reconstruct --mesh` share: makes a mesh from a file of points
// and writes it. Throws SetupError.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/contour.h"
#include "core/mesh/hole_fill.h"

namespace hermite::commands {

struct MeshMaking {
  mesh::ContourOptions contour;
  double simplify_mm = 0;      // 0: no simplification
  std::int64_t triangles = 0;  // of the simplified mesh: at least this many
  mesh::HoleFillOptions holes;
};

// Returns for the folder of a result the file from which meshes are made, or else its cloud; for a
// file that file.
std::string mesh_source_path(const std::string& result);

// Reads points with normals from a PLY file and writes their mesh as another, completely or not at
// all. Returns counts, areas and seconds.
nlohmann::ordered_json make_mesh_file(const std::string& points_path, const MeshMaking& making,
                                      const std::string& mesh_path);

}  // namespace hermite::commands
