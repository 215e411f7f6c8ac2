// A PLY file, as we or other programs write it: positions and faces, and what else vertices have.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Each but those of triangles is as many as positions, or none where vertices do not have all of its properties.
struct PlyShape {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;     // nx, ny, nz
  std::vector<Rgb8> colors;                 // red, green, blue: 8 or 16 bits, or a float from 0 to 1
  std::vector<float> radii;                 // radius
  std::vector<float> confidences;           // confidence
  std::vector<Eigen::Vector2f> curvatures;  // curvature_max, curvature_min
  std::vector<std::uint32_t> submaps;       // submap; what is no such number is 0
  std::vector<TriangleCorners> triangles;   // larger faces are cut into fans; empty for a cloud
  std::vector<std::uint8_t> is_filled;      // filled, of faces: by triangle, 0 or 1; empty where faces have none
};

// ASCII or binary little-endian; other elements and properties are skipped. kCorruptData, in words: cut, no x y z, a face that names a
// vertex that is not there, numbers that are none; kUnsupported: big-endian, lists as positions.
Result<PlyShape> parse_ply(std::string_view bytes);

// What format_ply has written; of another program's file what it lacks is 0, and its points are white. Metres.
Cloud cloud_of(const PlyShape& shape);

// What format_mesh_ply has written. Another program's file may lack normals, which then are means of those of the triangles around, by
// area, and colours, which then are white. Metres. kNotFound: there are no faces.
Result<TriangleMesh> mesh_of(PlyShape shape);

}  // namespace hermite
