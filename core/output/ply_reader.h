// Points and faces of a PLY file, as other programs write them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

struct PlyShape {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;                 // as many as positions, or none where vertices have no nx, ny, nz
  std::vector<Rgb8> colors;                             // the same with red, green, blue: 0 to 255, or 0 to 1 where they are float
  std::vector<float> radii;                             // the same with radius
  std::vector<float> confidences;                       // the same with confidence
  std::vector<std::array<std::uint32_t, 3>> triangles;  // larger faces are cut into fans; empty for a cloud
};

// ASCII or binary little-endian; other elements and properties are skipped. kCorruptData, in words: cut, no x y z, a face that names a
// vertex that is not there, numbers that are none; kUnsupported: big-endian, lists as positions.
Result<PlyShape> parse_ply(std::string_view bytes);

// Its vertices as points of one submap. What a file does not say is 0, white, or a confidence of 1. kInvalidArgument, with `name` in its
// words: no vertices, or none with normals, without which nobody knows a surface's sides.
Result<Cloud> cloud_of(const PlyShape& shape, const std::string& name);

}  // namespace hermite
