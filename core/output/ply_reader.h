// Reads a PLY file of this or another program: positions, faces and further vertex properties.
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

namespace hermite::output {

// Each per-vertex array is as long as positions, or empty if vertices lack one of its properties.
struct PlyShape {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  // nx, ny, nz
  // Red, green, blue: 8 or 16 bits, or a float from 0 to 1.
  std::vector<Rgb8> colors;
  std::vector<float> radii;                 // radius
  std::vector<float> confidences;           // confidence
  std::vector<Eigen::Vector2f> curvatures;  // curvature_max, curvature_min
  // Submap; other values than whole numbers become 0.
  std::vector<std::uint32_t> submaps;
  // Larger faces are split into fans; empty for a cloud.
  std::vector<TriangleCorners> triangles;
  // Filled, a property of faces: per triangle, 0 or 1; empty if faces lack it.
  std::vector<std::uint8_t> is_filled;
  // Subtracted from all positions, see PlyOptions.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<std::string> comments;  // of the header
};

struct PlyOptions {
  // If the first vertex with finite coordinates lies beyond kFarOff, positions become relative to a
  // round number near it: a float has 24 bits, which resolve only half a metre in the millions of
  // metres of a map projection.
  bool subtract_origin = false;
  std::uint64_t most_vertices = 200'000'000, most_triangles = 400'000'000;
};

inline constexpr double kFarOff = 1000, kOriginStep = 100;  // in the file's unit

// Returns the origin to subtract for this first position, which must be finite: 0 unless it lies
// beyond kFarOff.
Eigen::Vector3d origin_near(const Eigen::Vector3d& position);

// Parses ASCII or binary; other elements and properties are skipped. Returns kCorruptData with a
// message when the file is cut, lacks x y z, has a face with a missing vertex, invalid numbers or a
// header above 64 KiB; kTooLarge above the limits of the options; kUnsupported for lists as
// positions.
Result<PlyShape> parse_ply(std::string_view bytes, const PlyOptions& options = {});

// Converts a file of format_ply. In a file of another program, missing values are 0 and points
// without colour are white. Metres.
Cloud cloud_of(const PlyShape& shape);

// Converts a file of format_mesh_ply. In a file of another program, missing normals are
// area-weighted means of those of adjacent triangles, and missing colours are white. Metres.
// Returns kNotFound when there are no faces.
Result<TriangleMesh> mesh_of(PlyShape shape);

}  // namespace hermite::output
