#include "core/mesh/live_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/base/check.h"
#include "core/mesh/contour_cube.h"
#include "core/mesh/quad_mesh.h"
#include "core/output/spacing.h"

namespace hermite::mesh {
namespace {

constexpr double kCellPerSpacing = 1.25, kLeastLiveCell_m = 0.01, kMostLiveCell_m = 0.04;
constexpr std::size_t kLeastSurfels = 200;

// The distance of surfels is estimated from how many lie within this radius: a count that is cheap
// to update as surfels come and go. It is 30 where surfels are one cell apart.
constexpr float kNeighbourhood_cells = 3;
// As in FieldOptions.
constexpr double kSupport_spacings = 3;

// A surfel is updated only when it differs by more than this. A tenth of a cell is a millimetre,
// less than the error of a finished mesh; confidences are compared as the weights that they give.
constexpr double kAlike_cells = 0.1;
constexpr float kAlikeNormals = 0.9945f;  // 6 degrees
constexpr int kAlikeColors = 8;
constexpr float kAlikeConfidence = 2;
// The confidences between which viewers tell coverage by other colours (web/src/state/coverage.ts).
constexpr std::uint8_t kFairEighths = 8 * 6, kGoodEighths = 8 * 12;

// A cube has much new surface when an eighth of its surfels were added or removed.
constexpr std::int32_t kFreshShare = 8;

Eigen::Vector3i index_of(const SurfaceCube& cube) { return {cube.x, cube.y, cube.z}; }

bool is_alike_color(const Rgb8& a, const Rgb8& b) {
  return std::abs(a.r - b.r) <= kAlikeColors && std::abs(a.g - b.g) <= kAlikeColors &&
         std::abs(a.b - b.b) <= kAlikeColors;
}

int step_of_coverage(std::uint8_t eighths) {
  return (eighths >= kFairEighths ? 1 : 0) + (eighths >= kGoodEighths ? 1 : 0);
}

}  // namespace

std::optional<double> live_cell_m(std::span<const output::SlotChange> surfels) {
  std::vector<Eigen::Vector3f> positions_m;
  for (const output::SlotChange& change : surfels)
    if (change.alive && change.point.position_m.allFinite())
      positions_m.push_back(change.point.position_m);
  if (positions_m.size() < kLeastSurfels) return std::nullopt;
  std::vector<float> spacings_m = output::spacings_of_positions_m(positions_m);
  const auto middle = spacings_m.begin() + static_cast<std::ptrdiff_t>(spacings_m.size() / 2);
  std::nth_element(spacings_m.begin(), middle, spacings_m.end());
  return std::clamp(kCellPerSpacing * static_cast<double>(*middle), kLeastLiveCell_m,
                    kMostLiveCell_m);
}

LiveSurface::LiveSurface(double cell_m, std::size_t most_surfels)
    : cell_m_(cell_m), most_surfels_(most_surfels) {
  CHECK(cell_m >= kLeastCell_m && cell_m <= kMostCell_m, "a cell of that size cannot be contoured");
}

std::optional<LiveSurface::Entry> LiveSurface::entry_of(const output::CloudPoint& point) {
  if (!point.position_m.allFinite() || !point.normal.allFinite() ||
      !(point.normal.squaredNorm() > 0.25f))
    return std::nullopt;
  if (!(point.confidence > 0)) return std::nullopt;
  Entry entry;
  entry.position_m = point.position_m;
  entry.normal = point.normal.normalized();
  entry.confidence = std::min(point.confidence, kMostConfidence);
  entry.color = point.color;
  entry.confidence_eighths = output::eighths_of_confidence(point.confidence);
  entry.submap = point.submap;
  return entry;
}

bool LiveSurface::is_at_one_place(const Entry& a, const Entry& b) const {
  return a.submap == b.submap &&
         (a.position_m - b.position_m).norm() < static_cast<float>(kAlike_cells * cell_m_);
}

bool LiveSurface::looks_alike(const Entry& a, const Entry& b) {
  return a.normal.dot(b.normal) > kAlikeNormals && is_alike_color(a.color, b.color) &&
         a.confidence < kAlikeConfidence * b.confidence &&
         b.confidence < kAlikeConfidence * a.confidence;
}

// Cube indices have 16 bits, cell indices 20; one cube is kept free around the farthest ones.
bool LiveSurface::is_in_reach(const Eigen::Vector3f& world_m) const {
  static_assert(kMostCell / kCubeCells <= std::numeric_limits<std::int16_t>::max());
  const double most_m = (kMostCell - 4 * kCubeCells) * cell_m_;
  return world_m.allFinite() && static_cast<double>(world_m.cwiseAbs().maxCoeff()) < most_m;
}

float LiveSurface::spacing_m(std::int32_t neighbours) const {
  const float near_m = kNeighbourhood_cells * static_cast<float>(cell_m_);
  return near_m *
         std::sqrt(std::numbers::pi_v<float> / static_cast<float>(std::max(neighbours, 1)));
}

float LiveSurface::radius_m(std::int32_t neighbours) const {
  FieldKernel kernel;
  spread(kernel, spacing_m(neighbours), kSupport_spacings, cell_m_);
  return kernel.radius_m;
}

FieldKernel LiveSurface::kernel_of(const Entry& entry) const {
  FieldKernel kernel{entry.world_m, Eigen::Vector3f::Zero(), 0, entry.confidence, 0,
                     entry.color,   entry.confidence_eighths};
  kernel.normal =
      (submaps_[entry.submap].placed.world_from_submap.rotation * entry.normal.cast<double>())
          .cast<float>();
  spread(kernel, spacing_m(entry.neighbours), kSupport_spacings, cell_m_);
  return kernel;
}

SurfelGrid& LiveSurface::grid_of(std::uint32_t part) {
  return grid_of_part_.try_emplace(part, cell_m_).first->second;
}

LiveSurface::Cube& LiveSurface::cube_around(std::uint32_t slot) {
  const Entry& entry = entries_[slot];
  const Eigen::Vector3i cell = (entry.world_m.cast<double>() / cell_m_).array().floor().cast<int>();
  const Eigen::Vector3i index = cube_of(cell);
  return cubes_[{submaps_[entry.submap].placed.part, static_cast<std::int16_t>(index.x()),
                 static_cast<std::int16_t>(index.y()), static_cast<std::int16_t>(index.z())}];
}

// Marks all cubes whose surface depends on points within `reach_m` of this one.
void LiveSurface::touch(std::uint32_t part, const Eigen::Vector3f& world_m, float reach_m,
                        Time now) {
  const double reach_cells = static_cast<double>(reach_m) / cell_m_ + kCubeMargin + 1;
  const Eigen::Vector3d middle = world_m.cast<double>() / cell_m_;
  const Eigen::Vector3i first = cube_of((middle.array() - reach_cells).floor().cast<int>());
  const Eigen::Vector3i last = cube_of((middle.array() + reach_cells).floor().cast<int>());
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const SurfaceCube cube{part, static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                               static_cast<std::int16_t>(z)};
        if (dirty_.insert(cube).second) cubes_[cube].since = now;
      }
}

// Updates the neighbour counts around the surfel and its own, and marks all cubes that their
// supports reached before or reach now.
void LiveSurface::count_neighbour(std::uint32_t slot, int by, Time now) {
  const float near_m = kNeighbourhood_cells * static_cast<float>(cell_m_);
  const Eigen::Vector3f world_m = entries_[slot].world_m,
                        around_m = Eigen::Vector3f::Constant(near_m);
  const std::uint32_t part = submaps_[entries_[slot].submap].placed.part;
  float reach_m = radius_m(entries_[slot].neighbours);
  grid_of(part).for_each(world_m - around_m, world_m + around_m, [&](std::uint32_t other) {
    Entry& entry = entries_[other];
    const float distance_m = (entry.world_m - world_m).norm();
    if (other == slot || !(distance_m < near_m)) return;
    reach_m =
        std::max(reach_m, distance_m + radius_m(std::min(entry.neighbours, entry.neighbours + by)));
    entry.neighbours += by;
    entries_[slot].neighbours += by;
  });
  touch(part, world_m, std::max(reach_m, radius_m(entries_[slot].neighbours)), now);
}

void LiveSurface::insert(std::uint32_t slot, Time now) {
  Entry& entry = entries_[slot];
  Submap& submap = submaps_[entry.submap];
  entry.neighbours = 1;
  count_neighbour(slot, 1, now);
  grid_of(submap.placed.part).insert(slot, entry.world_m);
  submap.low_m =
      submap.is_used ? Eigen::Vector3f(submap.low_m.cwiseMin(entry.position_m)) : entry.position_m;
  submap.high_m =
      submap.is_used ? Eigen::Vector3f(submap.high_m.cwiseMax(entry.position_m)) : entry.position_m;
  submap.is_used = true;
  ++cube_around(slot).surfels;
  ++surfel_count_;
}

void LiveSurface::remove(std::uint32_t slot, Time now) {
  Entry& entry = entries_[slot];
  grid_of(submaps_[entry.submap].placed.part).remove(slot, entry.world_m);
  count_neighbour(slot, -1, now);
  --cube_around(slot).surfels;
  --surfel_count_;
}

// Updates a surfel that keeps its held position.
void LiveSurface::repaint(std::uint32_t slot, const Entry& as, Time now) {
  Entry& entry = entries_[slot];
  entry.normal = as.normal;
  entry.confidence = as.confidence;
  entry.color = as.color;
  entry.confidence_eighths = as.confidence_eighths;
  touch(submaps_[entry.submap].placed.part, entry.world_m, radius_m(entry.neighbours), now);
}

// The surface stays as it is; only how well it was seen may have to be told again.
void LiveSurface::set_confidence_eighths(std::uint32_t slot, std::uint8_t eighths, Time now) {
  Entry& entry = entries_[slot];
  const bool is_visible = step_of_coverage(eighths) != step_of_coverage(entry.confidence_eighths);
  entry.confidence_eighths = eighths;
  if (is_visible)
    touch(submaps_[entry.submap].placed.part, entry.world_m, radius_m(entry.neighbours), now);
}

void LiveSurface::apply(std::span<const output::SlotChange> changes, Time now) {
  for (const output::SlotChange& change : changes) {
    const std::uint32_t slot = change.slot;
    std::optional<Entry> entry = change.alive ? entry_of(change.point) : std::nullopt;
    if (entry) {
      CHECK(entry->submap < submaps_.size(), "a surfel of a submap that is nowhere");
      entry->world_m =
          (submaps_[entry->submap].placed.world_from_submap * entry->position_m.cast<double>())
              .cast<float>();
      if (!is_in_reach(entry->world_m)) entry.reset();
    }
    const bool was_there = slot < entries_.size() && entries_[slot].confidence > 0;
    if (!entry && !was_there) continue;
    if (entry && was_there && is_at_one_place(entries_[slot], *entry)) {
      if (looks_alike(entries_[slot], *entry))
        set_confidence_eighths(slot, entry->confidence_eighths, now);
      else
        repaint(slot, *entry, now);
      continue;
    }
    if (was_there) {
      if (!entry) ++cube_around(slot).came_or_went;
      remove(slot, now);
      entries_[slot].confidence = 0;
    }
    if (!entry) continue;
    if (slot >= entries_.size()) entries_.resize(std::size_t{slot} + 1);
    entries_[slot] = *entry;
    insert(slot, now);
    if (!was_there) ++cube_around(slot).came_or_went;
  }
}

bool LiveSurface::has_moved(const Submap& submap, const PlacedSubmap& now) const {
  if (submap.placed.part != now.part) return true;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at_m(
        static_cast<double>((corner & 1) != 0 ? submap.high_m.x() : submap.low_m.x()),
        static_cast<double>((corner & 2) != 0 ? submap.high_m.y() : submap.low_m.y()),
        static_cast<double>((corner & 4) != 0 ? submap.high_m.z() : submap.low_m.z()));
    const Eigen::Vector3d moved_m =
        submap.placed.world_from_submap * at_m - now.world_from_submap * at_m;
    if (!(moved_m.norm() < kMoved_cells * cell_m_)) return true;
  }
  return false;
}

void LiveSurface::move(std::uint32_t submap, const PlacedSubmap& to, Time now) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < entries_.size(); ++slot)
    if (entries_[slot].confidence > 0 && entries_[slot].submap == submap) slots.push_back(slot);
  for (const std::uint32_t slot : slots) remove(slot, now);
  submaps_[submap].placed = to;
  for (const std::uint32_t slot : slots) {
    Entry& entry = entries_[slot];
    entry.world_m = (to.world_from_submap * entry.position_m.cast<double>()).cast<float>();
    if (is_in_reach(entry.world_m))
      insert(slot, now);
    else
      entry.confidence = 0;
  }
}

void LiveSurface::place(std::span<const PlacedSubmap> submaps, Time now) {
  for (std::uint32_t i = 0; i < submaps.size(); ++i) {
    if (i >= submaps_.size()) submaps_.emplace_back();
    if (!submaps_[i].is_used)
      submaps_[i].placed = submaps[i];
    else if (has_moved(submaps_[i], submaps[i]))
      move(i, submaps[i], now);
  }
}

std::optional<SurfaceCube> LiveSurface::next(const Eigen::Vector3f& eye_m, Time now) const {
  using Rank = std::tuple<bool, Time, float, SurfaceCube>;
  std::optional<Rank> best;
  for (const SurfaceCube& index : dirty_) {
    const Cube& cube = cubes_.at(index);
    const bool is_fresh = cube.came_or_went > 0 &&
                          (!cube.was_made || cube.came_or_went * kFreshShare >= cube.surfels);
    if (!is_fresh && cube.was_made && now - cube.made < kCubeRest) continue;
    const Eigen::Vector3f middle_m =
        corner_m(kCubeCells * index_of(index) + Eigen::Vector3i::Constant(kCubeCells / 2));
    const Rank rank{!is_fresh, cube.since, (middle_m - eye_m).norm(), index};
    if (!best || rank < *best) best = rank;
  }
  return best ? std::optional(std::get<SurfaceCube>(*best)) : std::nullopt;
}

// Also determines the submap of most surfels in the cube, or, if there are none, of most surfels
// whose support reaches it.
std::vector<FieldKernel> LiveSurface::kernels_around(const SurfaceCube& cube,
                                                     std::uint32_t& submap) const {
  std::vector<FieldKernel> kernels;
  const auto grid = grid_of_part_.find(cube.part);
  if (grid == grid_of_part_.end()) return kernels;
  const Eigen::Vector3i first_cell = kCubeCells * index_of(cube);
  const Eigen::Vector3f inner_low_m = corner_m(first_cell),
                        inner_high_m = corner_m(first_cell + Eigen::Vector3i::Constant(kCubeCells));
  const auto margin = Eigen::Vector3i::Constant(kCubeMargin);
  const Eigen::Vector3f low_m = corner_m(first_cell - margin),
                        high_m =
                            corner_m(first_cell + Eigen::Vector3i::Constant(kCubeCells) + margin);
  const Eigen::Vector3f most_m = Eigen::Vector3f::Constant(radius_m(1));
  std::map<std::uint32_t, float> inside, around;
  grid->second.for_each(low_m - most_m, high_m + most_m, [&](std::uint32_t slot) {
    const Entry& entry = entries_[slot];
    const Eigen::Vector3f nearest_m = entry.world_m.cwiseMax(low_m).cwiseMin(high_m);
    const FieldKernel kernel = kernel_of(entry);
    if (!((nearest_m - entry.world_m).norm() < kernel.radius_m)) return;
    kernels.push_back(kernel);
    const bool is_inside = (entry.world_m.array() >= inner_low_m.array()).all() &&
                           (entry.world_m.array() < inner_high_m.array()).all();
    (is_inside ? inside : around)[entry.submap] += entry.confidence;
  });
  float most = 0;
  for (const auto& [number, weight] : inside.empty() ? around : inside)
    if (weight > most) std::tie(most, submap) = std::tuple(weight, number);
  return kernels;
}

std::optional<CubeMesh> LiveSurface::contour(const SurfaceCube& index, Time now) {
  CubeMesh made{index, 0, {}, now};
  std::vector<FieldKernel> kernels = kernels_around(index, made.submap);
  if (!kernels.empty())
    made.mesh =
        mesh_of(contour_whole_cube(SurfelField::of(std::move(kernels), cell_m_), index_of(index)));
  if (!made.mesh.triangles.empty()) {
    const Rigid3 submap_from_world = inverse(submaps_[made.submap].placed.world_from_submap);
    for (Eigen::Vector3f& position_m : made.mesh.positions_m)
      position_m = (submap_from_world * position_m.cast<double>()).cast<float>();
    for (Eigen::Vector3f& normal : made.mesh.normals)
      normal = (submap_from_world.rotation * normal.cast<double>()).cast<float>();
  }
  Cube& cube = cubes_[index];
  if (dirty_.erase(index) > 0) made.since = cube.since;
  const bool was_shown = std::exchange(cube.is_shown, !made.mesh.triangles.empty());
  cube.was_made = true;
  cube.made = now;
  cube.came_or_went = 0;
  const bool is_news = was_shown || cube.is_shown;
  if (!cube.is_shown && cube.surfels == 0) cubes_.erase(index);
  return is_news ? std::optional(std::move(made)) : std::nullopt;
}

std::vector<SurfaceCube> LiveSurface::shown() const {
  std::vector<SurfaceCube> shown;
  for (const auto& [index, cube] : cubes_)
    if (cube.is_shown) shown.push_back(index);
  return shown;
}

}  // namespace hermite::mesh
