#include "core/plan/wall_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>

namespace hermite::plan {

namespace {

using Eigen::Vector2d;

// Votes: for the direction of the normal, and for the distance of the line from the origin.
constexpr int kAngles = 180;  // of two degrees
constexpr double kAngle_rad = 2 * std::numbers::pi / kAngles;
constexpr double kOffset_m = 0.02;  // between the middles of bins, which are twice as wide
constexpr int kAnglesAround = 3;    // normals of single facets are off by up to six degrees
constexpr int kRefinements = 4;
constexpr double kFirstBand_m = 0.08;
constexpr int kLeastVotes = 400;  // facets: 0.25 m²
constexpr int kMostPeaks = 250;   // of which most are furniture
constexpr double kLeastWallLength_m = 0.3;
// A wall is at least as high as a man; where less was scanned, three quarters of what was, but
// never as low as a table.
constexpr double kWallTop_m = 1.8, kWallTopShare = 0.75, kLeastWallTop_m = 1;
constexpr double kSeenShare = 0.5;  // of the height of a column in which the wall counts as seen
constexpr int kRows = 64;
// Floor that continues behind a line, past its own noise and before the next leaf of the wall.
constexpr double kBehindFrom_m = 0.03, kBehindTo_m = 0.12;
// Cosine of ten degrees, and the share of the surface that a line along an axis has to explain.
constexpr double kNearAxis = 0.985, kAxisWorth = 0.85;
// The widest doorway that does not make one room of two.
constexpr double kWidestDoor_m = 1.3;
// Columns go on beyond what was seen of a wall, as far as a door may be away from it.
constexpr double kBeyond_m = 1.5;

double least_wall_top_m(double top_m) {
  return std::max(kLeastWallTop_m, std::min(kWallTop_m, kWallTopShare * top_m));
}

struct Upright {
  Vector2d at_m, normal;
  const PlanFacet* facet;
};

Vector2d direction_of(int angle) {
  const double rad = angle * kAngle_rad;
  return {std::cos(rad), std::sin(rad)};
}

class Votes {
 public:
  Votes(const std::vector<Upright>& facets, double reach_m)
      : offsets_(2 * static_cast<int>(std::ceil(reach_m / kOffset_m)) + 5),
        votes_(static_cast<std::size_t>(kAngles * offsets_)) {
    for (const Upright& facet : facets) add(facet, 1);
  }

  void add(const Upright& facet, int sign) {
    const int angle =
        static_cast<int>(std::lround(std::atan2(facet.normal.y(), facet.normal.x()) / kAngle_rad));
    for (int off = -kAnglesAround; off <= kAnglesAround; ++off) {
      const int voted = (angle + off + 2 * kAngles) % kAngles;
      const int offset =
          static_cast<int>(std::floor(direction_of(voted).dot(facet.at_m) / kOffset_m)) +
          offsets_ / 2;
      for (int bin = offset; bin <= offset + 1; ++bin)
        votes_[static_cast<std::size_t>(voted * offsets_ + std::clamp(bin, 0, offsets_ - 1))] +=
            sign;
    }
  }

  struct Peak {
    int votes = 0;
    Vector2d normal = Vector2d::UnitX();
    double offset_m = 0;
  };
  Peak best() const {
    const auto found = std::max_element(votes_.begin(), votes_.end());
    const int index = static_cast<int>(found - votes_.begin());
    return {*found, direction_of(index / offsets_), (index % offsets_ - offsets_ / 2) * kOffset_m};
  }

 private:
  int offsets_;
  std::vector<int> votes_;
};

int count_near(const WallLine& line, std::span<const Upright> facets) {
  return static_cast<int>(
      std::count_if(facets.begin(), facets.end(),
                    [&line](const Upright& facet) { return is_of_wall(line, *facet.facet); }));
}

// Most walls are parallel or perpendicular to each other: the line along an axis is taken unless
// another one explains clearly more.
void prefer_axes(WallLine& line, std::span<const Upright> facets) {
  Eigen::Index axis = 0;
  line.normal.cwiseAbs().maxCoeff(&axis);
  WallLine straight;
  straight.normal = (line.normal[axis] < 0 ? -1 : 1) *
                    (axis == 0 ? Vector2d(Vector2d::UnitX()) : Vector2d(Vector2d::UnitY()));
  if (straight.normal.dot(line.normal) < kNearAxis) return;
  // Through the part of the wall with the most surface, which is where the histogram of distances
  // has its peak.
  constexpr double kBin_m = kWallBand_m / 2;
  std::map<int, std::pair<int, double>> bins;
  for (const Upright& facet : facets)
    if (is_of_wall(line, *facet.facet)) {
      auto& [count, sum_m] =
          bins[static_cast<int>(std::floor(straight.normal.dot(facet.at_m) / kBin_m))];
      ++count;
      sum_m += straight.normal.dot(facet.at_m);
    }
  const auto fullest = std::max_element(bins.begin(), bins.end(), [](const auto& a, const auto& b) {
    return a.second.first < b.second.first;
  });
  if (fullest == bins.end()) return;
  straight.offset_m = fullest->second.second / fullest->second.first;
  if (count_near(straight, facets) >= kAxisWorth * count_near(line, facets)) line = straight;
}

// Fits the line to the facets near it, in narrowing bands. False: nothing is there.
bool refine(WallLine& line, std::span<const Upright> facets) {
  double band_m = kFirstBand_m;
  for (int round = 0; round < kRefinements; ++round, band_m = std::max(kWallBand_m, 0.7 * band_m)) {
    double count = 0;
    Vector2d sum = Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    for (const Upright& facet : facets) {
      if (std::abs(line.distance_m(facet.at_m)) > band_m ||
          facet.normal.dot(line.normal) < kWallCosine)
        continue;
      ++count;
      sum += facet.at_m;
      squares += facet.at_m * facet.at_m.transpose();
    }
    if (count < 3) return false;
    const Vector2d centre = sum / count;
    const Eigen::Matrix2d spread = squares / count - centre * centre.transpose();
    // The direction of the smaller spread, in closed form.
    const double turn_rad = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
    Vector2d normal(-std::sin(turn_rad), std::cos(turn_rad));
    if (normal.dot(line.normal) < 0) normal = -normal;
    if (normal.dot(line.normal) < kWallCosine) return false;
    line.normal = normal;
    line.offset_m = normal.dot(centre);
  }
  return true;
}

std::uint64_t row_bit(double height_m) {
  const double row = std::floor(height_m / kRow_m);
  return row < 0 || row >= kRows ? 0 : std::uint64_t{1} << static_cast<int>(row);
}

void fill_columns(WallLine& line, std::span<const Upright> facets) {
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const Upright& facet : facets)
    if (is_of_wall(line, *facet.facet)) {
      low_m = std::min(low_m, line.place_m(facet.at_m));
      high_m = std::max(high_m, line.place_m(facet.at_m));
    }
  if (low_m > high_m) return;
  low_m -= kBeyond_m;
  high_m += kBeyond_m;
  line.first_m = kColumn_m * std::floor(low_m / kColumn_m);
  line.columns.assign(static_cast<std::size_t>((high_m - line.first_m) / kColumn_m) + 1, 0);
  for (const Upright& facet : facets)
    if (is_of_wall(line, *facet.facet))
      line.columns[static_cast<std::size_t>((line.place_m(facet.at_m) - line.first_m) /
                                            kColumn_m)] |= row_bit(facet.facet->at_m.z());
}

// The length over which it stands high enough.
double wall_length_m(const WallLine& line, double top_m) {
  const auto count =
      std::count_if(line.columns.begin(), line.columns.end(),
                    [top_m](std::uint64_t column) { return wall_support(column, top_m) > 0.5; });
  return kColumn_m * static_cast<double>(count);
}

void look_behind(WallLine& line, const std::vector<PlanFacet>& facets) {
  line.floor_behind.assign(line.columns.size(), false);
  for (const PlanFacet& facet : facets) {
    if (facet.normal.z() < kLevelCosine || std::abs(facet.at_m.z()) > kLevel_m) continue;
    const Vector2d at_m = facet.at_m.head<2>();
    const double behind_m = -line.distance_m(at_m);
    if (behind_m < kBehindFrom_m || behind_m > kBehindTo_m) continue;
    if (const std::size_t column = line.index_at(line.place_m(at_m)); column < line.columns.size())
      line.floor_behind[column] = true;
  }
}

// Returns the angle from the axes to most of what stands high enough to be a wall.
double turn_rad_of(const std::vector<WallLine>& lines, double top_m) {
  double x = 0, y = 0;
  for (const WallLine& line : lines) {
    const double length_m = wall_length_m(line, top_m),
                 four_rad = 4 * std::atan2(line.normal.y(), line.normal.x());
    x += length_m * std::cos(four_rad);
    y += length_m * std::sin(four_rad);
  }
  return std::atan2(y, x) / 4;
}

void turn(PlanSurface& surface, double angle_rad) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(-angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  surface.frame.plan_from_world = rotation * surface.frame.plan_from_world;
  for (PlanFacet& facet : surface.facets) {
    facet.at_m = rotation * facet.at_m;
    facet.normal = rotation * facet.normal;
  }
}

// Gaps between two parts of a wall that are no wider than a doorway have the support of their
// sides.
std::vector<double> support_of(const std::vector<std::uint64_t>& columns, double top_m) {
  std::vector<double> support;
  for (const std::uint64_t column : columns) support.push_back(wall_support(column, top_m));
  std::size_t end_of_last = 0;  // of the columns before this gap; 0: there are none
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (support[i] < kSeenShare) continue;
    if (end_of_last > 0 && static_cast<double>(i - end_of_last) * kColumn_m <= kWidestDoor_m)
      for (std::size_t gap = end_of_last; gap < i; ++gap)
        support[gap] = std::min(support[end_of_last - 1], support[i]);
    end_of_last = i + 1;
  }
  return support;
}

std::vector<Upright> upright_facets(const PlanSurface& surface) {
  std::vector<Upright> facets;
  for (const PlanFacet& facet : surface.facets)
    if (std::abs(facet.normal.z()) < kUpright)
      facets.push_back({facet.at_m.head<2>(), facet.normal.head<2>().normalized(), &facet});
  return facets;
}

// Finds the largest line, takes its facets away, and so on.
std::vector<WallLine> lines_in(std::vector<Upright> facets, double top_m, bool prefers_axes) {
  double reach_m = 0;
  for (const Upright& facet : facets) reach_m = std::max(reach_m, facet.at_m.norm());
  Votes votes(facets, reach_m);
  std::vector<WallLine> lines;
  for (int peaks = 0; peaks < kMostPeaks && lines.size() < kMostWallLines; ++peaks) {
    const Votes::Peak peak = votes.best();
    if (peak.votes < kLeastVotes) break;
    WallLine line;
    line.normal = peak.normal;
    line.offset_m = peak.offset_m;
    const bool is_line = refine(line, facets);
    if (is_line && prefers_axes) prefer_axes(line, facets);
    if (is_line) fill_columns(line, facets);
    // What voted for this peak goes, whether or not it is a wall, so that the next one is another.
    const auto rest = std::partition(facets.begin(), facets.end(), [&](const Upright& facet) {
      const bool is_of_peak = std::abs(peak.normal.dot(facet.at_m) - peak.offset_m) <= kOffset_m &&
                              facet.normal.dot(peak.normal) > 0.97;
      return !is_of_peak && !(is_line && is_of_wall(line, *facet.facet));
    });
    for (auto gone = rest; gone != facets.end(); ++gone) votes.add(*gone, -1);
    facets.erase(rest, facets.end());
    if (is_line && wall_length_m(line, top_m) >= kLeastWallLength_m)
      lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

std::size_t WallLine::index_at(double along_m) const {
  const double column = std::floor((along_m - first_m) / kColumn_m);
  return column < 0 || column >= static_cast<double>(columns.size())
             ? columns.size()
             : static_cast<std::size_t>(column);
}

bool is_of_wall(const WallLine& line, const PlanFacet& facet) {
  return std::abs(facet.normal.z()) < kUpright &&
         std::abs(line.distance_m(facet.at_m.head<2>())) <= kWallBand_m &&
         facet.normal.head<2>().dot(line.normal) >= kWallCosine;
}

double wall_support(std::uint64_t column, double top_m) {
  if (column == 0) return 0;
  const int highest = static_cast<int>(std::bit_width(column)) - 1;
  if ((highest + 1) * kRow_m < least_wall_top_m(top_m)) return 0;
  const double rows = std::clamp(std::floor(top_m / kRow_m), 1.0, double{kRows});
  return std::min(1.0, std::popcount(column) / rows / kSeenShare);
}

double wall_support(const WallLine& line, double from_m, double to_m) {
  const int count = std::max(1, static_cast<int>((to_m - from_m) / kColumn_m));
  double sum = 0;
  for (int i = 0; i < count; ++i)
    if (const std::size_t column = line.index_at(from_m + (i + 0.5) * (to_m - from_m) / count);
        column < line.support.size())
      sum += line.support[column];
  return sum / count;
}

std::vector<WallLine> find_wall_lines(PlanSurface& surface) {
  const double top_m = surface.frame.top_m;
  turn(surface, turn_rad_of(lines_in(upright_facets(surface), top_m, false), top_m));
  std::vector<WallLine> lines = lines_in(upright_facets(surface), top_m, true);
  for (WallLine& line : lines) {
    line.support = support_of(line.columns, top_m);
    look_behind(line, surface.facets);
  }
  return lines;
}

void mark_passed(std::vector<WallLine>& lines, const std::vector<SightLine>& sight_lines) {
  for (WallLine& line : lines) {
    line.passed.assign(line.columns.size(), 0);
    for (const SightLine& sight : sight_lines) {
      const double from_m = line.distance_m(sight.from_m.head<2>()),
                   to_m = line.distance_m(sight.to_m.head<2>());
      if (from_m * to_m >= 0) continue;
      const Eigen::Vector3d at_m =
          sight.from_m + from_m / (from_m - to_m) * (sight.to_m - sight.from_m);
      if (const std::size_t column = line.index_at(line.place_m(at_m.head<2>()));
          column < line.columns.size())
        line.passed[column] |= row_bit(at_m.z());
    }
  }
}

}  // namespace hermite::plan
