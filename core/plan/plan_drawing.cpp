#include "core/plan/plan_drawing.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/printf_text.h"

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

constexpr std::array kScales{10, 20, 50, 100, 200, 500, 1000};
constexpr double kPaper_mm[] = {380, 237};  // of an A3 without margins and foot
constexpr double kMargin_mm = 18, kFoot_mm = 18, kLeastWidth_mm = 120;
constexpr double kLabelFrom_mm = 16;                      // shorter walls have no length written
constexpr double kLengthOff_mm = 3.5, kDoorOff_mm = 7.5;  // of texts from their wall
// Half the distance of the lines of a hole.
constexpr double kWindow_mm = 0.7;
constexpr std::array kBars_m{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
constexpr double kLongestBar_mm = 60;

struct Extent {
  Vector2d low_m = Vector2d::Constant(1e9), high_m = Vector2d::Constant(-1e9);
};

Extent extent_of(const FloorPlan& plan) {
  Extent extent;
  for (const PlanRoom& room : plan.rooms)
    for (const PlanLoop& loop : room.loops)
      for (const PlanWall& wall : loop) {
        extent.low_m = extent.low_m.cwiseMin(wall.from_m);
        extent.high_m = extent.high_m.cwiseMax(wall.from_m);
      }
  return extent;
}

int scale_of(const Vector2d& size_m) {
  const double long_mm = 1000 * size_m.maxCoeff(), short_mm = 1000 * size_m.minCoeff();
  for (const int scale : kScales)
    if (long_mm / scale <= kPaper_mm[0] && short_mm / scale <= kPaper_mm[1]) return scale;
  return kScales.back();
}

// Draws with y down and the upper left corner at the margin.
class Paper {
 public:
  Paper(const Extent& extent, int scale)
      : left_m_(extent.low_m.x()),
        high_m_(extent.high_m.y()),
        mm_per_m_(1000.0 / scale),
        size_mm_(mm_per_m_ * (extent.high_m - extent.low_m)) {}

  Vector2d at(const Vector2d& place_m) const {
    return {kMargin_mm + mm_per_m_ * (place_m.x() - left_m_),
            kMargin_mm + mm_per_m_ * (high_m_ - place_m.y())};
  }
  double mm_per_m() const { return mm_per_m_; }
  double width_mm() const { return std::max(kLeastWidth_mm, size_mm_.x() + 2 * kMargin_mm); }
  double height_mm() const { return size_mm_.y() + 2 * kMargin_mm + kFoot_mm; }

 private:
  double left_m_, high_m_, mm_per_m_;
  Vector2d size_mm_;
};

std::string line(const Vector2d& from, const Vector2d& to, const char* style) {
  return printf_text("<path class=\"%s\" d=\"M%.2f %.2fL%.2f %.2f\"/>\n", style, from.x(), from.y(),
                     to.x(), to.y());
}

std::string text(const Vector2d& at, double turn_deg, const char* style, const std::string& words) {
  return printf_text(
      "<text class=\"%s\" transform=\"translate(%.2f %.2f) rotate(%.1f)\">%s</text>\n", style,
      at.x(), at.y(), turn_deg, words.c_str());
}

// The angle at which a text along the wall is read from below or from the right.
double reading_deg(const Vector2d& along) {
  double angle_deg = std::atan2(along.y(), along.x()) * 180 / M_PI;
  if (angle_deg > 90) angle_deg -= 180;
  if (angle_deg <= -90) angle_deg += 180;
  return angle_deg;
}

// The lines of a wall, and the lengths beside it, inside of the room.
struct DrawnWall {
  std::string lines, lengths;
};

// `is_whole`: the walls at both of its ends were seen, so that its length is known.
DrawnWall drawn_wall(const PlanWall& wall, bool is_whole, const Paper& paper) {
  const Vector2d along = (wall.to_m - wall.from_m).normalized(), inside(-along.y(), along.x());
  const auto place = [&](double along_m, double off_mm) {
    return paper.at(wall.from_m + along_m * along + off_mm / paper.mm_per_m() * inside);
  };
  const double turn_deg = reading_deg(paper.at(wall.to_m) - paper.at(wall.from_m));
  DrawnWall drawn;
  for (const WallPart& part : parts_of(wall)) {
    const auto stroke = [&](double off_mm, const char* style) {
      drawn.lines += line(place(part.from_m, off_mm), place(part.to_m, off_mm), style);
    };
    if (!wall.is_seen || (part.opening && part.opening->kind == OpeningKind::kUnseen)) {
      stroke(0, "unseen");
    } else if (!part.opening) {
      stroke(0, "wall");
    } else if (part.opening->kind == OpeningKind::kHole) {
      stroke(-kWindow_mm, "thin");
      stroke(kWindow_mm, "thin");
    } else {
      stroke(0, "thin");
      drawn.lengths += text(place(0.5 * (part.from_m + part.to_m), kDoorOff_mm), turn_deg, "length",
                            printf_text("%.2f", part.to_m - part.from_m));
    }
  }
  if (wall.length.length_m * paper.mm_per_m() >= kLabelFrom_mm && wall.is_seen && is_whole)
    drawn.lengths += text(place(0.5 * wall.length.length_m, kLengthOff_mm), turn_deg, "length",
                          printf_text("%.3f", wall.length.length_m));
  return drawn;
}

std::string drawn_ground(const PlanRoom& room, const Paper& paper) {
  std::string outline;
  for (const PlanLoop& loop : room.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vector2d at = paper.at(loop[i].from_m);
      outline += printf_text("%s%.2f %.2f", i == 0 ? "M" : "L", at.x(), at.y());
    }
    outline += "Z";
  }
  return fmt::format("<path class=\"room\" d=\"{}\"/>\n", outline);
}

std::string label_of(const PlanRoom& room, std::size_t number, const Paper& paper) {
  constexpr double kLine_mm = 6.5;
  std::vector<std::pair<const char*, std::string>> lines{{"name", "Room " + std::to_string(number)},
                                                         {"area", area_text(room)}};
  if (room.height_m) lines.emplace_back("area", printf_text("height %.2f m", *room.height_m));
  Vector2d at = paper.at(room.label_at_m) -
                Vector2d(0, 0.5 * kLine_mm * static_cast<double>(lines.size() - 1));
  std::string svg;
  for (const auto& [style, words] : lines) {
    svg += text(at, 0, style, words);
    at.y() += kLine_mm;
  }
  return svg;
}

// The ground of all rooms lies below all lines, and these below all texts.
std::string drawn_rooms(const FloorPlan& plan, const Paper& paper) {
  std::string ground, lines, texts;
  for (std::size_t i = 0; i < plan.rooms.size(); ++i) {
    const PlanRoom& room = plan.rooms[i];
    ground += drawn_ground(room, paper);
    texts += label_of(room, i + 1, paper);
    for (const PlanLoop& loop : room.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const bool is_whole = loop[(k + loop.size() - 1) % loop.size()].is_seen &&
                              loop[(k + 1) % loop.size()].is_seen;
        const DrawnWall drawn = drawn_wall(loop[k], is_whole, paper);
        lines += drawn.lines;
        texts += drawn.lengths;
      }
  }
  return ground + lines + texts;
}

std::string scale_bar(const Paper& paper) {
  double bar_m = kBars_m.front();
  for (const double each_m : kBars_m)
    if (each_m * paper.mm_per_m() <= kLongestBar_mm) bar_m = each_m;
  const Vector2d from(kMargin_mm, paper.height_mm() - kMargin_mm),
      to = from + Vector2d(bar_m * paper.mm_per_m(), 0), tick(0, -2);
  return line(from, to, "thin") + line(from, from + tick, "thin") + line(to, to + tick, "thin") +
         text(to + Vector2d(2, 0), 0, "foot", printf_text("%g m", bar_m));
}

}  // namespace

std::vector<WallPart> parts_of(const PlanWall& wall) {
  std::vector<WallPart> parts;
  double at_m = 0;
  for (const PlanOpening& opening : wall.openings) {
    const double from_m = std::clamp(opening.from_m, at_m, wall.length.length_m),
                 to_m = std::min(opening.to_m, wall.length.length_m);
    if (to_m <= from_m) continue;
    if (from_m > at_m) parts.push_back({at_m, from_m, nullptr});
    parts.push_back({from_m, to_m, &opening});
    at_m = to_m;
  }
  if (at_m < wall.length.length_m) parts.push_back({at_m, wall.length.length_m, nullptr});
  return parts;
}

std::string area_text(const PlanRoom& room) {
  if (!room.is_closed()) {
    const bool lacks_walls = room.seen_share < room.ground_share;
    return printf_text("about %.1f m² (%.0f %% of the %s seen)", room.area_m2,
                       std::floor(100 * (lacks_walls ? room.seen_share : room.ground_share)),
                       lacks_walls ? "outline" : "ground");
  }
  if (!room.area_half_width_m2) return printf_text("%.2f m²", room.area_m2);
  return printf_text("%.2f m² ± %.2f m²", room.area_m2,
                     std::ceil(100 * *room.area_half_width_m2) / 100);
}

std::string format_plan_svg(const FloorPlan& plan) {
  const Extent extent = extent_of(plan);
  const int scale = scale_of(extent.high_m - extent.low_m);
  const Paper paper(extent, scale);
  const std::string size =
      printf_text("width=\"%.2fmm\" height=\"%.2fmm\" viewBox=\"0 0 %.2f %.2f\"", paper.width_mm(),
                  paper.height_mm(), paper.width_mm(), paper.height_mm());
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" " +
      size +
      R"(>
<title>Floor plan</title>
<desc>Walls are thick lines, doors thin ones with their width, and holes of the surface, )"
      R"(as windows and mirrors make them, double ones.
Dashed lines were not seen. Lengths are in metres, intervals contain the truth with )"
      R"(a probability of 95 %.</desc>
<style>
.room{fill:#f3f1ec;fill-rule:evenodd}
.wall{stroke:#111;stroke-width:1.2;stroke-linecap:square;fill:none}
.thin{stroke:#111;stroke-width:.25;fill:none}
.unseen{stroke:#888;stroke-width:.4;stroke-dasharray:2 1.5;fill:none}
text{font-family:sans-serif;fill:#111;text-anchor:middle;dominant-baseline:central}
.name{font-size:6px;font-weight:bold}
.area{font-size:4.5px}
.length{font-size:3.5px}
.foot{font-size:4.5px;text-anchor:start}
</style>
<rect width="100%" height="100%" fill="#fff"/>
)";
  svg += drawn_rooms(plan, paper) + scale_bar(paper);
  return svg +
         text({kMargin_mm, paper.height_mm() - kMargin_mm + 7}, 0, "foot",
              printf_text("1:%d, lengths in metres", scale)) +
         "</svg>\n";
}

}  // namespace hermite::plan
