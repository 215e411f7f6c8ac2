#include "core/synthetic/world_walls.h"

#include <algorithm>

#include "core/base/check.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector2d;

// A leaf ends this far before the other face of the wall, inside the leaf of the other area.
constexpr double kShort_m = 0.01;
constexpr double kLeaf_m = kWall_m - kShort_m;
// Depth by which walls and floors extend into the shell.
constexpr double kDeep_m = 0.3;
constexpr double kFloor_m = 0.006;
// Lining and casing of a door frame: thickness in the opening, width beside it.
constexpr double kLining_m = 0.015, kCasing_m = 0.05;
constexpr float kLamp_m = 2.3f, kWindow_m = 1.7f;  // heights as in the furnished room
constexpr double kSkirtingDepth_m = 0.016, kCasingDepth_m = 0.02;

bool runs_along_x(Side side) { return side == Side::kNorth || side == Side::kSouth; }

Span along_wall(const Area& area, Side side) { return runs_along_x(side) ? area.x : area.y; }

// Returns the parts of a wall between its openings, each opening widened by `margin` at both ends.
std::vector<Span> between_openings(const Area& area, Side side,
                                   const std::vector<Opening>& openings, double margin) {
  std::vector<double> middles;
  for (const Opening& opening : openings)
    if (opening.side == side) middles.push_back(opening.middle);
  std::sort(middles.begin(), middles.end());
  std::vector<Span> spans;
  const Span whole = along_wall(area, side);
  double low = whole.low;
  for (const double middle : middles) {
    spans.push_back({low, middle - kDoor_m / 2 - margin});
    low = middle + kDoor_m / 2 + margin;
  }
  spans.push_back({low, whole.high});
  return spans;
}

void add_wall(Furnisher& f, const Area& area, Side side, const AreaLook& look,
              const std::vector<Opening>& openings) {
  const int material = look.walls[static_cast<std::size_t>(side)];
  const Span whole = along_wall(area, side), leaf{-kLeaf_m, 0};
  const Span upright{-kDeep_m, kRoomHeight_m + kDeep_m};
  for (Span span : between_openings(area, side, openings, 0)) {
    // The leaves of two sides fill the corner.
    if (span.low == whole.low) span.low -= kLeaf_m;
    if (span.high == whole.high) span.high += kLeaf_m;
    on_wall(f, {area, side}, {span, leaf, upright}, material);
  }
  for (const Span& span : between_openings(area, side, openings, kCasing_m))
    on_wall(f, {area, side}, {span, {-kSunk_m, kSkirtingDepth_m}, {-kSunk_m, kSkirting_m}},
            look.trim);
  const Span through{-kWall_m / 2, kCasingDepth_m};
  for (const Opening& opening : openings) {
    if (opening.side != side) continue;
    const Span gap{opening.middle - kDoor_m / 2, opening.middle + kDoor_m / 2};
    on_wall(f, {area, side}, {gap, leaf, {kDoorTop_m, upright.high}}, material);
    on_wall(
        f, {area, side},
        {{gap.low - kCasing_m, gap.low + kLining_m}, through, {-kSunk_m, kDoorTop_m - kLining_m}},
        look.trim);
    on_wall(
        f, {area, side},
        {{gap.high - kLining_m, gap.high + kCasing_m}, through, {-kSunk_m, kDoorTop_m - kLining_m}},
        look.trim);
    on_wall(f, {area, side},
            {{gap.low - kCasing_m, gap.high + kCasing_m},
             through,
             {kDoorTop_m - kLining_m, kDoorTop_m + kCasing_m}},
            look.trim);
  }
}

}  // namespace

void add_shell(Furnisher& f, const std::vector<Area>& areas, const ShellLook& look) {
  CHECK(f.out.shapes.empty() && f.out.materials.empty() && !areas.empty(), "the shell comes first");
  Span x = areas.front().x, y = areas.front().y;
  for (const Area& area : areas) {
    x = {std::min(x.low, area.x.low), std::max(x.high, area.x.high)};
    y = {std::min(y.low, area.y.low), std::max(y.high, area.y.high)};
  }
  // In the order of the room's faces: -x, +x, -y, +y, floor, ceiling.
  for (const Paint& paint : {look.wall, look.wall, look.wall, look.wall, look.floor, look.ceiling})
    f.material(paint.pattern, paint.first, paint.second);
  f.add(ShapeKind::kRoom,
        {(x.high - x.low + kWall_m) / 2, (y.high - y.low + kWall_m) / 2, kRoomHeight_m / 2},
        {(x.low + x.high) / 2, (y.low + y.high) / 2, kRoomHeight_m / 2}, 0);
}

void add_area(Furnisher& f, const Area& area, const AreaLook& look,
              const std::vector<Opening>& openings) {
  for (const Side side : {Side::kNorth, Side::kWest, Side::kSouth, Side::kEast})
    add_wall(f, area, side, look, openings);
  const double half_wall = kWall_m / 2;
  f.box({area.x.low - half_wall, area.x.high + half_wall},
        {area.y.low - half_wall, area.y.high + half_wall}, {-kDeep_m, kFloor_m}, look.floor);
}

void light_area(Furnisher& f, const Area& area, Side window) {
  const Vector2d low(area.x.low, area.y.low), high(area.x.high, area.y.high),
      middle = (low + high) / 2;
  const Vector2d at = at_wall(area, window, runs_along_x(window) ? middle.x() : middle.y());
  // The tube is as far from the ends as from the sides; in a square it is a point.
  const Vector2d reach = (high - low) / 2, tube = (reach.array() - reach.minCoeff()).matrix();
  const auto at_height = [](const Vector2d& place, float z) {
    return Eigen::Vector3f(static_cast<float>(place.x()), static_cast<float>(place.y()), z);
  };
  f.out.lights.push_back({low.cast<float>(), high.cast<float>(), at_height(middle - tube, kLamp_m),
                          at_height(middle + tube, kLamp_m), at_height(at, kWindow_m)});
}

Shape& on_wall(Furnisher& f, Wall wall, const WallBox& box, int material) {
  const auto& [along, depth, z] = box;
  const Area& area = wall.area;
  switch (wall.side) {
    case Side::kNorth:
      return f.box(along, {area.y.high - depth.high, area.y.high - depth.low}, z, material);
    case Side::kSouth:
      return f.box(along, {area.y.low + depth.low, area.y.low + depth.high}, z, material);
    case Side::kWest:
      return f.box({area.x.low + depth.low, area.x.low + depth.high}, along, z, material);
    case Side::kEast: break;
  }
  return f.box({area.x.high - depth.high, area.x.high - depth.low}, along, z, material);
}

Vector2d at_wall(const Area& area, Side side, double along) {
  switch (side) {
    case Side::kNorth: return {along, area.y.high};
    case Side::kSouth: return {along, area.y.low};
    case Side::kWest: return {area.x.low, along};
    case Side::kEast: break;
  }
  return {area.x.high, along};
}

void add_painting(Furnisher& f, const Area& area, Side side, const WallPainting& painting) {
  const auto span = [](double middle, double length) {
    return Span{middle - length / 2, middle + length / 2};
  };
  on_wall(
      f, {area, side},
      {span(painting.along, painting.width), {-kSunk_m, 0.022}, span(painting.z, painting.height)},
      painting.frame);
  on_wall(f, {area, side},
          {span(painting.along, painting.width - 0.08),
           {-kSunk_m, 0.027},
           span(painting.z, painting.height - 0.08)},
          painting.image);
}

}  // namespace hermite::synthetic
