#include "core/output/glb_parts.h"

#include <cmath>
#include <limits>
#include <utility>

#include "core/output/axes.h"

namespace hermite::output {
namespace {

constexpr std::uint32_t kNotYet = std::numeric_limits<std::uint32_t>::max();

// Tabulates the sRGB transfer function (IEC 61966-2-1) for all 256 values.
std::array<std::uint16_t, 256> linear_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double srgb = static_cast<double>(i) / 255;
    const double linear = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
    table[i] = static_cast<std::uint16_t>(std::lround(65535 * linear));
  }
  return table;
}

// Returns the part with those triangles of [first, last) that are filled, or those that are not.
GlbPart part_of(const TriangleMesh& mesh, std::size_t first, std::size_t last, bool is_filled,
                std::vector<std::uint32_t>& place_of_vertex) {
  GlbPart part;
  part.is_filled = is_filled;
  std::vector<std::uint32_t> used;
  for (std::size_t i = first; i < last; ++i) {
    if ((!mesh.is_filled.empty() && mesh.is_filled[i] != 0) != is_filled) continue;
    TriangleCorners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = place_of_vertex[mesh.triangles[i][k]];
      if (place == kNotYet) {
        place = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.triangles[i][k]);
      }
      corners[k] = place;
    }
    part.triangles.push_back(corners);
  }
  for (const std::uint32_t vertex : used) {
    part.positions.push_back(y_up(mesh.positions_m[vertex]));
    part.normals.push_back(unit_normal_y_up(mesh.normals[vertex]));
    if (mesh.pages.empty()) part.colors.push_back(linear_color(mesh.colors[vertex]));
    if (!mesh.pages.empty()) part.texture_coordinates.push_back(mesh.texture_coordinates[vertex]);
    place_of_vertex[vertex] = kNotYet;
  }
  return part;
}

}  // namespace

LinearRgba16 linear_color(Rgb8 color) {
  static const std::array<std::uint16_t, 256> table = linear_table();
  return {table[color.r], table[color.g], table[color.b], 65535};
}

Eigen::Vector3f unit_normal_y_up(const Eigen::Vector3f& normal) {
  const float length = normal.stableNorm();
  return length > 0 && std::isfinite(length) ? Eigen::Vector3f(y_up(normal) / length)
                                             : Eigen::Vector3f(0, 1, 0);
}

std::vector<GlbPart> glb_parts(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> place_of_vertex(mesh.positions_m.size(), kNotYet);
  std::vector<GlbPart> parts;
  const auto add = [&](std::size_t page, std::size_t first, std::size_t last) {
    for (const bool is_filled : {false, true}) {
      if (is_filled && mesh.is_filled.empty()) continue;
      GlbPart part = part_of(mesh, first, last, is_filled, place_of_vertex);
      part.page = page;
      if (!part.triangles.empty()) parts.push_back(std::move(part));
    }
  };
  if (mesh.pages.empty()) add(0, 0, mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.pages.size(); ++i) {
    const std::size_t first = mesh.pages[i].first_triangle;
    add(i, first, first + mesh.pages[i].triangle_count);
  }
  return parts;
}

}  // namespace hermite::output
