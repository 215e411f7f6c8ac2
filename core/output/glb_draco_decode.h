// Decodes what a primitive of a glTF has as KHR_draco_mesh_compression. Bytes may be anybody's. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Unique ids of Draco's attributes; below 0: there is none.
struct DracoIds {
  std::int64_t position = -1, normal = -1, color = -1, texture_coordinate = -1;
};

// Arrays by vertex are empty where there is no such attribute.
struct DracoMesh {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector3f> colors;  // 0 to 1
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<TriangleCorners> triangles;  // of vertices that are there
};

// `vertex_count` and `triangle_count` are what the glTF says: kCorruptData for another one, for no mesh, for an attribute that is not there
// or has other numbers of components.
Result<DracoMesh> decode_draco_mesh(std::string_view bytes, const DracoIds& ids, std::uint64_t vertex_count, std::uint64_t triangle_count);

}  // namespace hermite
