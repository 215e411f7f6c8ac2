// Positions, normals, radii and faces of a PLY file, as other programs write them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

struct PlyShape {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;                 // as many as positions, or none where vertices have no nx, ny, nz
  std::vector<float> radii;                             // the same with radius
  std::vector<std::array<std::uint32_t, 3>> triangles;  // larger faces are cut into fans; empty for a cloud
};

// ASCII or binary little-endian; other elements and properties are skipped. kCorruptData, in words: cut, no x y z, a face that names a
// vertex that is not there, numbers that are none; kUnsupported: big-endian, lists as positions.
Result<PlyShape> parse_ply(std::string_view bytes);

}  // namespace hermite
