#include "core/edit/plane_cut.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/mesh/mesh_parts.h"

namespace hermite::edit {

namespace {

// Cuts that pass a vertex nearer than this would leave slivers. It is far below what depth cameras
// measure.
constexpr double kInPlane_m = 1e-4;

using Pieces = std::vector<output::TriangleCorners>;

class PlaneCut {
 public:
  PlaneCut(output::TriangleMesh& mesh, const Eigen::Vector3d& normal, double at_m)
      : mesh_(mesh), heights_m_(mesh.positions_m.size()) {
    for (std::size_t i = 0; i < heights_m_.size(); ++i) {
      const double height_m = normal.dot(mesh.positions_m[i].cast<double>()) - at_m;
      heights_m_[i] = std::abs(height_m) <= kInPlane_m ? 0 : height_m;
    }
  }

  // Appends the pieces of a triangle, or the triangle itself.
  void append_pieces(const output::TriangleCorners& triangle, Pieces& pieces) {
    const auto [low, high] =
        std::minmax({heights_m_[triangle[0]], heights_m_[triangle[1]], heights_m_[triangle[2]]});
    if (low >= 0 || high <= 0) {
      pieces.push_back(triangle);
      return;
    }
    // The corner that has no other one on its side comes first.
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t alone = triangle[k], next = triangle[(k + 1) % 3],
                          last = triangle[(k + 2) % 3];
      const bool is_above = heights_m_[alone] > 0;
      if (heights_m_[alone] == 0 || is_on_side(next, is_above) || is_on_side(last, is_above))
        continue;
      const std::uint32_t to_next = between(alone, next), to_last = between(alone, last);
      pieces.push_back({alone, to_next, to_last});
      if (to_next != next) pieces.push_back({to_next, next, last});
      if (to_last != last) pieces.push_back({to_next, last, to_last});
      return;
    }
  }

 private:
  bool is_on_side(std::uint32_t vertex, bool above) const {
    return above ? heights_m_[vertex] > 0 : heights_m_[vertex] < 0;
  }

  // Returns the vertex where an edge meets the plane. It is computed from below to above, so that
  // edges at the same place have it at the same place.
  std::uint32_t between(std::uint32_t a, std::uint32_t b) {
    if (heights_m_[b] == 0) return b;
    const std::uint32_t below = heights_m_[a] < 0 ? a : b, above = heights_m_[a] < 0 ? b : a;
    const std::uint64_t edge = std::uint64_t{below} << 32 | above;
    const auto [found, is_new] =
        known_.try_emplace(edge, static_cast<std::uint32_t>(mesh_.positions_m.size()));
    if (!is_new) return found->second;
    const auto share =
        static_cast<float>(heights_m_[below] / (heights_m_[below] - heights_m_[above]));
    const auto mixed = [share](const auto& from, const auto& to) {
      return (from + share * (to - from)).eval();
    };
    mesh_.positions_m.push_back(mixed(mesh_.positions_m[below], mesh_.positions_m[above]));
    mesh_.normals.push_back(mixed(mesh_.normals[below], mesh_.normals[above]).normalized());
    mesh_.colors.push_back(mixed_color(mesh_.colors[below], mesh_.colors[above], share));
    if (!mesh_.texture_coordinates.empty())
      mesh_.texture_coordinates.push_back(
          mixed(mesh_.texture_coordinates[below], mesh_.texture_coordinates[above]));
    heights_m_.push_back(0);
    return found->second;
  }

  static Rgb8 mixed_color(const Rgb8& from, const Rgb8& to, float share) {
    const auto mixed = [share](std::uint8_t a, std::uint8_t b) {
      return static_cast<std::uint8_t>(std::lround(
          static_cast<float>(a) + share * (static_cast<float>(b) - static_cast<float>(a))));
    };
    return {mixed(from.r, to.r), mixed(from.g, to.g), mixed(from.b, to.b)};
  }

  output::TriangleMesh& mesh_;
  std::vector<double> heights_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> known_;
};

// Replaces each triangle by those that append(triangle, pieces) appends, with its mark and in its
// page.
template <class Append>
void replace_triangles(output::TriangleMesh& mesh, const Append& append) {
  Pieces pieces;
  pieces.reserve(mesh.triangles.size());
  std::vector<std::uint8_t> is_filled;
  std::vector<output::TexturePage> pages;
  const auto replace = [&](std::size_t i) {
    append(mesh.triangles[i], pieces);
    if (!mesh.is_filled.empty()) is_filled.resize(pieces.size(), mesh.is_filled[i]);
  };
  if (mesh.pages.empty())
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) replace(i);
  for (output::TexturePage& page : mesh.pages) {
    const auto first = static_cast<std::uint32_t>(pieces.size());
    for (std::uint32_t i = 0; i < page.triangle_count; ++i) replace(page.first_triangle + i);
    const auto count = static_cast<std::uint32_t>(pieces.size()) - first;
    if (count > 0) pages.push_back({std::move(page.image), first, count});
  }
  mesh.triangles = std::move(pieces);
  mesh.is_filled = std::move(is_filled);
  mesh.pages = std::move(pages);
}

}  // namespace

void cut_by_plane(output::TriangleMesh& mesh, const Eigen::Vector3d& normal, double at_m) {
  PlaneCut cut(mesh, normal, at_m);
  replace_triangles(mesh, [&cut](const output::TriangleCorners& triangle, Pieces& pieces) {
    cut.append_pieces(triangle, pieces);
  });
}

void keep_triangles(output::TriangleMesh& mesh,
                    const std::function<bool(const output::TriangleCorners& triangle)>& is_kept) {
  replace_triangles(mesh, [&is_kept](const output::TriangleCorners& triangle, Pieces& pieces) {
    if (is_kept(triangle)) pieces.push_back(triangle);
  });
  mesh::remove_unused_vertices(mesh);
}

}  // namespace hermite::edit
