// A PLY file, as we or other programs write it: positions and faces, and what else vertices have.
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
#include "core/output/triangle_mesh.h"

namespace hermite {

// Each but those of triangles is as many as positions, or none where vertices do not have all of its properties.
struct PlyShape {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;              // nx, ny, nz
  std::vector<Rgb8> colors;                          // red, green, blue: 8 or 16 bits, or a float from 0 to 1
  std::vector<float> radii;                          // radius
  std::vector<float> confidences;                    // confidence
  std::vector<Eigen::Vector2f> curvatures;           // curvature_max, curvature_min
  std::vector<std::uint32_t> submaps;                // submap; what is no such number is 0
  std::vector<TriangleCorners> triangles;            // larger faces are cut into fans; empty for a cloud
  std::vector<std::uint8_t> is_filled;               // filled, of faces: by triangle, 0 or 1; empty where faces have none
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // what was subtracted from all positions, see PlyOptions
  std::vector<std::string> comments;                 // of the header
};

struct PlyOptions {
  // A file whose first vertex with finite coordinates lies beyond kFarOff gets its positions relative to a round number near it: a float
  // has 24 bits, which are half a metre of the millions of metres of a map projection.
  bool subtract_origin = false;
  std::uint64_t most_vertices = 200'000'000, most_triangles = 400'000'000;
};

inline constexpr double kFarOff = 1000, kOriginStep = 100;  // in the file's unit

// The number that is subtracted when this is the first position: 0 unless it lies beyond kFarOff. Finite.
Eigen::Vector3d origin_near(const Eigen::Vector3d& position);

// ASCII or binary; other elements and properties are skipped. kCorruptData, in words: cut, no x y z, a face that names a vertex that is not
// there, numbers that are none, a header of more than 64 KiB; kTooLarge: more than the options allow; kUnsupported: lists as positions.
Result<PlyShape> parse_ply(std::string_view bytes, const PlyOptions& options = {});

// What format_ply has written; of another program's file what it lacks is 0, and its points are white. Metres.
Cloud cloud_of(const PlyShape& shape);

// What format_mesh_ply has written. Another program's file may lack normals, which then are means of those of the triangles around, by
// area, and colours, which then are white. Metres. kNotFound: there are no faces.
Result<TriangleMesh> mesh_of(PlyShape shape);

}  // namespace hermite
