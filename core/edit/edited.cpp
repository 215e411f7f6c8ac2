#include "core/edit/edited.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/edit/plane_cut.h"

namespace hermite::edit {

namespace {

// The extent of each part, and the part of each vertex or point.
struct Parts {
  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> part_of;
  std::map<std::uint32_t, Eigen::AlignedBox3f> boxes;

  void add(std::size_t i, std::uint32_t part, const Eigen::Vector3f& position_m) {
    part_of[i] = part;
    boxes[part].extend(position_m);
  }
  // By vertex or point.
  std::vector<bool> is_kept(double least_m) const {
    const auto extent_m = [](const Eigen::AlignedBox3f& box) {
      return static_cast<double>(box.diagonal().norm());
    };
    double largest_m = 0;
    for (const auto& [part, box] : boxes) largest_m = std::max(largest_m, extent_m(box));
    std::map<std::uint32_t, bool> of_part{{kNone, true}};
    for (const auto& [part, box] : boxes)
      of_part[part] = extent_m(box) >= std::min(least_m, largest_m);
    std::vector<bool> kept(part_of.size());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = of_part.at(part_of[i]);
    return kept;
  }
};

using PositionBits = std::array<std::uint32_t, 3>;

PositionBits bits_of(const Eigen::Vector3f& position_m) {
  const Eigen::Vector3f without_minus_zero = position_m + Eigen::Vector3f::Zero();
  PositionBits bits;
  std::memcpy(bits.data(), without_minus_zero.data(), sizeof(bits));
  return bits;
}

struct HashOfTriple {
  template <class Triple>
  std::size_t operator()(const Triple& triple) const {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a, by numbers
    for (const auto number : triple)
      hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x100000001b3;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

Parts parts_of(const output::TriangleMesh& mesh) {
  DisjointSets sets(mesh.positions_m.size());
  // The borders of texture charts have vertices twice.
  std::unordered_map<PositionBits, std::uint32_t, HashOfTriple> first_there;
  for (std::uint32_t i = 0; i < mesh.positions_m.size(); ++i)
    sets.join(first_there.try_emplace(bits_of(mesh.positions_m[i]), i).first->second, i);
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.join(a, b);
    sets.join(a, c);
  }
  Parts parts{std::vector<std::uint32_t>(mesh.positions_m.size(), Parts::kNone), {}};
  for (const output::TriangleCorners& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      parts.add(corner, sets.root(corner), mesh.positions_m[corner]);
  return parts;
}

using Cell = std::array<std::int64_t, 3>;
constexpr double kFarthestCell = 1e15;  // as integers, cells around it still differ

Cell cell_of(const Eigen::Vector3f& position_m) {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = std::floor(position_m[static_cast<Eigen::Index>(axis)] / kConnected_m);
    cell[axis] = static_cast<std::int64_t>(std::clamp(at, -kFarthestCell, kFarthestCell));
  }
  return cell;
}

Parts parts_of(const output::Cloud& cloud) {
  std::unordered_map<Cell, std::uint32_t, HashOfTriple> cells;
  std::vector<std::uint32_t> cell_of_point(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud[i].position_m.allFinite()) continue;
    const auto next = static_cast<std::uint32_t>(cells.size());
    cell_of_point[i] = cells.try_emplace(cell_of(cloud[i].position_m), next).first->second;
  }
  DisjointSets sets(cells.size());  // the same sets in whatever order they are joined
  for (const auto& [cell, number] : cells)
    for (int i = 0; i < 27; ++i)
      if (const auto near =
              cells.find({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
          near != cells.end())
        sets.join(number, near->second);
  Parts parts{std::vector<std::uint32_t>(cloud.size(), Parts::kNone), {}};
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].position_m.allFinite())
      parts.add(i, sets.root(cell_of_point[i]), cloud[i].position_m);
  return parts;
}

Eigen::Vector3d middle_of(const output::TriangleMesh& mesh,
                          const output::TriangleCorners& triangle) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t corner : triangle) sum += mesh.positions_m[corner].cast<double>();
  return sum / 3;
}

void apply(const ScanEdit& edit, output::TriangleMesh& mesh) {
  if (edit.kind == EditKind::kRemoveFloating) {
    const std::vector<bool> kept = parts_of(mesh).is_kept(edit.smaller_than_m);
    keep_triangles(mesh,
                   [&kept](const output::TriangleCorners& triangle) { return kept[triangle[0]]; });
    return;
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double at_m : {edit.box.low_m[axis], edit.box.high_m[axis]})
      cut_by_plane(mesh, edit.box.axes.row(axis), at_m);
  const bool inside = edit.kind == EditKind::kKeepInside;
  keep_triangles(mesh, [&](const output::TriangleCorners& triangle) {
    return edit.box.holds(middle_of(mesh, triangle)) == inside;
  });
}

void apply(const ScanEdit& edit, output::Cloud& cloud) {
  if (edit.kind == EditKind::kRemoveFloating) {
    const std::vector<bool> kept = parts_of(cloud).is_kept(edit.smaller_than_m);
    std::size_t count = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (kept[i]) cloud[count++] = cloud[i];
    cloud.resize(count);
    return;
  }
  const bool inside = edit.kind == EditKind::kKeepInside;
  std::erase_if(cloud, [&](const output::CloudPoint& point) {
    return edit.box.holds(point.position_m.cast<double>()) != inside;
  });
}

}  // namespace

output::Cloud edited(output::Cloud cloud, std::span<const ScanEdit> edits) {
  for (const ScanEdit& edit : edits) apply(edit, cloud);
  return cloud;
}

output::TriangleMesh edited(output::TriangleMesh mesh, std::span<const ScanEdit> edits) {
  for (const ScanEdit& edit : edits) apply(edit, mesh);
  return mesh;
}

}  // namespace hermite::edit
