// Decodes a glTF primitive with KHR_draco_mesh_compression from untrusted bytes. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Unique ids of Draco attributes; negative: absent.
struct DracoIds {
  std::int64_t position = -1, normal = -1, color = -1, texture_coordinate = -1;
};

// Per-vertex arrays are empty if the attribute is absent.
struct DracoMesh {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector3f> colors;  // 0 to 1
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<TriangleCorners> triangles;  // indices are in range
};

// `vertex_count` and `triangle_count` are the counts in the glTF. Returns kCorruptData when Draco's
// counts differ, the bytes are not a mesh, or an attribute is missing or has another number of
// components.
Result<DracoMesh> decode_draco_mesh(std::string_view bytes, const DracoIds& ids,
                                    std::uint64_t vertex_count, std::uint64_t triangle_count);

}  // namespace hermite::output
