#include "core/output/mesh_ply.h"

#include <fmt/core.h>

#include "core/base/check.h"
#include "core/output/mesh_check.h"

namespace hermite::output {

std::string format_mesh_ply(const TriangleMesh& mesh) {
  const std::size_t count = mesh.positions_m.size();
  CHECK(mesh.normals.size() == count && mesh.colors.size() == count,
        "per-vertex arrays differ in length");
  CHECK(mesh.is_filled.empty() || mesh.is_filled.size() == mesh.triangles.size(),
        "the number of filled marks is not that of triangles");
  CHECK(count <= kMaxMeshVertices, "the number of vertices exceeds an int");
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "comment Hermite: metres, normals out of the surface, counter-clockwise from outside\n"
      "element vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face {}\nproperty list uchar int vertex_indices\n{}end_header\n",
      count, mesh.triangles.size(), mesh.is_filled.empty() ? "" : "property uchar filled\n");
  constexpr std::size_t kVertex_bytes = 6 * sizeof(float) + sizeof(Rgb8),
                        kFace_bytes = 2 + sizeof(TriangleCorners);
  bytes.reserve(bytes.size() + count * kVertex_bytes + mesh.triangles.size() * kFace_bytes);
  const auto append = [&bytes](const void* values, std::size_t size) {
    bytes.append(static_cast<const char*>(values), size);
  };
  for (std::size_t i = 0; i < count; ++i) {
    append(mesh.positions_m[i].data(), 3 * sizeof(float));
    append(mesh.normals[i].data(), 3 * sizeof(float));
    append(&mesh.colors[i], sizeof(Rgb8));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    bytes.push_back(3);
    append(mesh.triangles[i].data(), sizeof(TriangleCorners));
    if (!mesh.is_filled.empty()) bytes.push_back(static_cast<char>(mesh.is_filled[i]));
  }
  return bytes;
}

}  // namespace hermite::output
