// Reads one primitive of a glTF file, and the base colour of its material. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/import/glb_document.h"
#include "core/output/triangle_mesh.h"

namespace hermite::imports {

// The base colour of a material: a linear factor and an optional texture.
struct GlbMaterial {
  Eigen::Vector3f factor = Eigen::Vector3f::Ones();
  std::optional<std::uint64_t> image;
  std::uint64_t coordinates = 0;  // TEXCOORD_0, _1, ...
  Eigen::Matrix<float, 2, 3> image_from_uv =
      (Eigen::Matrix<float, 2, 3>() << 1, 0, 0, 0, 1, 0).finished();
  bool is_plain = true;  // the texture uses TEXCOORD_0 without a transform
  // Written by this program for triangles across filled holes (core/output/glb.h).
  bool is_filled = false;
};

// A primitive in the frame of its mesh. Per-vertex arrays are empty if the attribute is missing;
// texture coordinates are already transformed.
struct GlbPrimitive {
  GlbMaterial material;
  bool is_points = false;
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector3f> colors;  // linear
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<output::TriangleCorners> triangles;  // indices are in range
};

// What remains of the limits for the whole file.
struct GlbBudget {
  std::uint64_t vertices = 0, triangles = 0;
};

// Reads an entry of meshes[].primitives, called `where` in messages, and subtracts its size from
// the budget. Returns kCorruptData naming the field for a missing reference or arrays of different
// lengths, kTooLarge beyond the budget, kUnsupported for lines and sparse accessors.
Result<GlbPrimitive> read_glb_primitive(const GlbDocument& document,
                                        const nlohmann::json& primitive, const std::string& where,
                                        GlbBudget& budget);

}  // namespace hermite::imports
