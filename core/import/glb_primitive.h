// What one primitive of a glTF is made of, and its material as far as colours go. Pure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/import/glb_document.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// Of a material: the colour that all is multiplied with, linear, and its picture.
struct GlbMaterial {
  Eigen::Vector3f factor = Eigen::Vector3f::Ones();
  std::optional<std::uint64_t> image;
  std::uint64_t coordinates = 0;  // TEXCOORD_0, _1, ...
  Eigen::Matrix<float, 2, 3> image_from_uv = (Eigen::Matrix<float, 2, 3>() << 1, 0, 0, 0, 1, 0).finished();
  bool is_plain = true;    // the picture lies by TEXCOORD_0 as it is
  bool is_filled = false;  // this program wrote it, for triangles across filled holes (core/output/glb.h)
};

// In its own frame. Arrays by vertex are empty where it has none; texture coordinates are those of the picture.
struct GlbPrimitive {
  GlbMaterial material;
  bool is_points = false;
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector3f> colors;  // linear
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<TriangleCorners> triangles;  // of vertices that are there
};

// How much may still come.
struct GlbBudget {
  std::uint64_t vertices = 0, triangles = 0;
};

// An entry of meshes[].primitives; `where` is what it is called. What it has is taken from the budget. kCorruptData, naming the field: what
// it names is not there, arrays of different lengths; kTooLarge: beyond the budget; kUnsupported: lines, sparse accessors.
Result<GlbPrimitive> read_glb_primitive(const GlbDocument& document, const nlohmann::json& primitive, const std::string& where,
                                        GlbBudget& budget);

}  // namespace hermite
