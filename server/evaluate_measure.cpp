#include "server/evaluate_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/base/printf_text.h"
#include "core/dataset/text_file.h"
#include "core/evaluate/true_points.h"
#include "core/math/counted_random.h"
#include "core/measure/area.h"
#include "core/measure/distance.h"
#include "core/measure/measure.h"
#include "core/measure/plane_measures.h"
#include "core/mesh/surfel_grid.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"
#include "server/ply_file.h"
#include "server/result_files.h"

namespace hermite::commands {

namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// Deviation of a mesh from the surface where a user clicks on it (tests/accuracy/README.md,
// "Mesh").
constexpr double kPickDeviation_m = 0.002;

constexpr std::array kClassBounds_m{0.0, 0.5, 1.0,
                                    2.0, 4.0, std::numeric_limits<double>::infinity()};

// Measurements that need planes take some hundredths of a second each.
constexpr std::size_t kPairsForOnePlane = 20;
constexpr int kMostDrawnCorners = 8;

class Surfels {
 public:
  explicit Surfels(output::Cloud cloud)
      : cloud_(std::move(cloud)), grid_(measure::kFitReach_m / mesh::SurfelGrid::kBinCells) {
    for (std::size_t i = 0; i < cloud_.size(); ++i)
      grid_.insert(static_cast<std::uint32_t>(i), cloud_[i].position_m);
  }

  Result<measure::MeasuredPlace> fit(const Vector3d& pick) const {
    return measure::fit_surface_point(around(pick, measure::kFitReach_m), pick);
  }
  Result<measure::MeasuredPlane> plane(const measure::MeasuredPlace& place, bool one_submap) const {
    return measure::fit_plane(around(place.position_m, measure::kPlaneReach_m), place, one_submap);
  }

 private:
  output::Cloud around(const Vector3d& middle, double reach_m) const {
    output::Cloud found;
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(static_cast<float>(reach_m));
    grid_.for_each(middle.cast<float>() - reach, middle.cast<float>() + reach,
                   [&](std::uint32_t slot) { found.push_back(cloud_[slot]); });
    return found;
  }

  output::Cloud cloud_;
  mesh::SurfelGrid grid_;
};

struct JudgedPoint {
  evaluate::TruePoint truth;
  measure::MeasuredPlace found;
};

struct JudgedPlane {
  evaluate::TruePlane truth;
  measure::MeasuredPlane found;
};

struct Judged {
  double truth = 0;
  measure::Quantity found;
  bool is_inside() const { return std::abs(found.value - truth) <= found.half_width; }
};

struct JudgedKind {
  std::vector<Judged> all;
  std::size_t tried = 0;

  void add(double truth, const Result<measure::Quantity>& found) {
    ++tried;
    if (found.ok()) all.push_back({truth, *found});
  }
  double refused() const {
    return 1 -
           static_cast<double>(all.size()) / static_cast<double>(std::max<std::size_t>(1, tried));
  }
};

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

// The outline must be planar.
double outline_area_m2(const std::vector<Vector3d>& corners) {
  Vector3d doubled = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i)
    doubled += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  return doubled.norm() / 2;
}

// Holds a result with its ground truth, and measures random things in it.
class MeasureJudge {
 public:
  MeasureJudge(const MeasureJudging& judging, const evaluate::TruePlaces& truth, Surfels surfels,
               measure::MapKnowledge map)
      : seed_(judging.seed),
        pairs_(static_cast<std::size_t>(judging.pairs)),
        truth_(truth),
        surfels_(std::move(surfels)),
        map_(std::move(map)) {
    // A quarter more than needed, since some cannot be measured at.
    const std::vector<evaluate::TruePoint> points = truth.points(pairs_ * 5 / 2, seed_);
    for (std::size_t i = 0; i < points.size(); ++i) points_.push_back(judged(points[i], i));
  }

  JudgedKind distances() const {
    JudgedKind kind;
    for (std::size_t i = 1; i < points_.size() && kind.all.size() < pairs_; i += 2)
      if (points_[i - 1] && points_[i])
        kind.add((points_[i - 1]->truth.true_m - points_[i]->truth.true_m).norm(),
                 measure::distance_between(points_[i - 1]->found, points_[i]->found, map_));
      else
        ++kind.tried;
    return kind;
  }

  // Up is the true one, transformed into the world frame of the estimate, with the error of an
  // estimated one.
  JudgedKind heights() const {
    JudgedKind kind;
    const Vector3d true_up = truth_.true_up(), up = truth_.estimate_from_true() * true_up;
    for (std::size_t i = 1; i < points_.size() && kind.all.size() < pairs_; i += 2) {
      if (!points_[i - 1] || !points_[i]) continue;
      const NormalPair tilt = normal_pair(frame_key(seed_, -2), i);
      const Vector3d along = up.unitOrthogonal(), across = up.cross(along);
      const Vector3d found_up =
          (up + measure::kUpSigma_rad * (tilt.a * along + tilt.b * across)).normalized();
      kind.add(std::abs(true_up.dot(points_[i - 1]->truth.true_m - points_[i]->truth.true_m)),
               measure::height_between(points_[i - 1]->found, points_[i]->found, found_up, map_));
    }
    return kind;
  }

  // Measures where the ground truth has planes.
  JudgedKind planes_and_angles(JudgedKind& angles) const {
    JudgedKind kind;
    for (std::size_t i = 1; i < points_.size() && kind.tried < pairs_ / kPairsForOnePlane; i += 2) {
      if (!points_[i - 1] || !points_[i]) continue;
      const std::optional<evaluate::TruePlane> true_plane =
          truth_.plane_at(points_[i]->truth.pixel);
      if (!true_plane) continue;
      const Result<measure::MeasuredPlane> plane =
          surfels_.plane(points_[i]->found, map_.part_count > 1);
      const JudgedPoint& from = *points_[i - 1];
      kind.add(std::abs(true_plane->normal.dot(from.truth.true_m - true_plane->centre_m)),
               plane.ok() ? measure::distance_to_plane(from.found, *plane, map_) : plane.error());
      const std::optional<evaluate::TruePlane> other_true = truth_.plane_at(from.truth.pixel);
      if (!other_true) continue;
      const Result<measure::MeasuredPlane> other = surfels_.plane(from.found, map_.part_count > 1);
      angles.add(180 - angle_deg(true_plane->normal, other_true->normal),
                 !plane.ok()   ? plane.error()
                 : !other.ok() ? other.error()
                               : measure::angle_between(*plane, *other, map_));
    }
    return kind;
  }

  // Alternates between three arbitrary points, and 3 to 8 points of a true plane.
  JudgedKind areas() const {
    JudgedKind kind;
    for (std::size_t i = 2; i < points_.size() && kind.tried < pairs_ / kPairsForOnePlane; i += 3) {
      const std::vector<std::optional<JudgedPoint>> corners =
          i % 2 == 0 ? std::vector(points_.begin() + static_cast<std::ptrdiff_t>(i) - 2,
                                   points_.begin() + static_cast<std::ptrdiff_t>(i) + 1)
                     : corners_in_plane(i);
      std::vector<Vector3d> true_corners;
      std::vector<measure::MeasuredPlace> found_corners;
      for (const std::optional<JudgedPoint>& corner : corners) {
        if (!corner) continue;
        true_corners.push_back(corner->truth.true_m);
        found_corners.push_back(corner->found);
      }
      if (true_corners.size() >= 3)
        kind.add(outline_area_m2(true_corners), measure::area_of(found_corners, map_));
    }
    return kind;
  }

 private:
  // Returns std::nullopt if nothing can be measured there.
  std::optional<JudgedPoint> judged(const evaluate::TruePoint& point, std::size_t counter) const {
    const Result<measure::MeasuredPlace> there = surfels_.fit(point.estimated_m);
    if (!there.ok()) return std::nullopt;
    const double off_m = kPickDeviation_m * normal_pair(frame_key(seed_, -1), counter).a;
    const Result<measure::MeasuredPlace> found =
        surfels_.fit(point.estimated_m + off_m * there->normal);
    return found.ok() ? std::optional(JudgedPoint{point, *found}) : std::nullopt;
  }

  // Orders the corners by angle around the centre, so that the outline does not cross itself.
  std::vector<std::optional<JudgedPoint>> corners_in_plane(std::size_t index) const {
    if (!points_[index]) return {};
    const std::optional<evaluate::TruePlane> plane = truth_.plane_at(points_[index]->truth.pixel);
    if (!plane) return {};
    const std::uint64_t key = frame_key(seed_, -3 - static_cast<std::int64_t>(index));
    const int count = 3 + static_cast<int>(unit_uniform(key, 0) * (kMostDrawnCorners - 2));
    std::vector<std::optional<JudgedPoint>> corners;
    Vector3d middle = Vector3d::Zero();
    for (int i = 1; i <= count; ++i) {
      const auto chosen =
          static_cast<std::size_t>(unit_uniform(key, static_cast<std::uint64_t>(i)) *
                                   static_cast<double>(plane->pixels.size()));
      const std::optional<evaluate::TruePoint> point = truth_.point_at(plane->pixels[chosen]);
      std::optional<JudgedPoint> corner =
          point ? judged(*point,
                         points_.size() + index * kMostDrawnCorners + static_cast<std::size_t>(i))
                : std::nullopt;
      if (!corner) continue;
      middle += corner->truth.true_m;
      corners.push_back(std::move(corner));
    }
    if (corners.empty()) return {};
    middle /= static_cast<double>(corners.size());
    const Vector3d along = plane->normal.unitOrthogonal(), across = plane->normal.cross(along);
    const auto turn = [&](const std::optional<JudgedPoint>& corner) {
      return std::atan2((corner->truth.true_m - middle).dot(across),
                        (corner->truth.true_m - middle).dot(along));
    };
    std::stable_sort(corners.begin(), corners.end(),
                     [&](const auto& a, const auto& b) { return turn(a) < turn(b); });
    return corners;
  }

  const std::uint64_t seed_;
  const std::size_t pairs_;
  const evaluate::TruePlaces& truth_;
  const Surfels surfels_;
  const measure::MapKnowledge map_;
  std::vector<std::optional<JudgedPoint>> points_;
};

// Summarises measurements whose true value is at least `from` and less than `to`.
Json summary_of(const std::vector<Judged>& all, double from, double to, const char* count_key) {
  std::vector<double> half_widths, errors;
  std::size_t inside = 0;
  for (const Judged& one : all) {
    if (one.truth < from || one.truth >= to) continue;
    half_widths.push_back(one.found.half_width);
    errors.push_back(std::abs(one.found.value - one.truth));
    inside += one.is_inside();
  }
  Json summary{{count_key, errors.size()}};
  if (errors.empty()) return summary;
  summary["inside"] = static_cast<double>(inside) / static_cast<double>(errors.size());
  summary["median_half_width"] = median_of(half_widths);
  summary["median_error"] = median_of(errors);
  return summary;
}

constexpr double kEverything = std::numeric_limits<double>::infinity();

Json json_of(const JudgedKind& kind) {
  Json json = summary_of(kind.all, -kEverything, kEverything, "count");
  json["tried"] = kind.tried;
  json["refused"] = kind.refused();
  return json;
}

std::string csv_of(const std::vector<const JudgedKind*>& kinds) {
  std::string text = "kind,true,measured,half_width,surface_sigma,pose_sigma,way_m\n";
  for (const JudgedKind* kind : kinds)
    for (const Judged& one : kind->all)
      text += std::string(measure::row_of(one.found.kind).name) +
              printf_text(",%.6f,%.6f,%.6f,%.6f,%.6f,%.3f\n", one.truth, one.found.value,
                          one.found.half_width, one.found.surface_sigma, one.found.pose_sigma,
                          one.found.way_m);
  return text;
}

}  // namespace

Json evaluate_measure(const MeasureJudging& judging) {
  const ResultFiles files = or_throw(read_result_files(judging.result));
  measure::MapKnowledge map =
      or_throw(measure::map_knowledge_of(files.trajectory_text, files.report_json));
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(judging.sequence));
  const dataset::Trajectory estimate =
      or_throw(dataset::parse_tum_trajectory(files.trajectory_text));
  const evaluate::TruePlaces truth = or_throw(evaluate::TruePlaces::of(*sequence, estimate));
  const MeasureJudge judge(
      judging, truth, Surfels(output::cloud_of(read_ply_file(judging.result + "/surfels.ply"))),
      std::move(map));
  const JudgedKind distances = judge.distances(), heights = judge.heights(), areas = judge.areas();
  JudgedKind angles;
  const JudgedKind planes = judge.planes_and_angles(angles);
  Json json = summary_of(distances.all, 0, kEverything, "pairs");
  json["tried"] = distances.tried;
  json["refused"] = distances.refused();
  json["half_width_at_1m_m"] =
      summary_of(distances.all, 0.9, 1.1, "pairs").value("median_half_width", 0.0);
  for (std::size_t i = 1; i < kClassBounds_m.size(); ++i) {
    Json one = summary_of(distances.all, kClassBounds_m[i - 1], kClassBounds_m[i], "pairs");
    one["from_m"] = kClassBounds_m[i - 1];
    json["classes"].push_back(one);
  }
  const Vector3d up = truth.estimate_from_true() * truth.true_up();
  json["up"] = {up.x(), up.y(), up.z()};
  const std::vector<const JudgedKind*> others{&planes, &heights, &angles, &areas};
  const std::array names{measure::MeasureKind::kPlane, measure::MeasureKind::kHeight,
                         measure::MeasureKind::kAngle, measure::MeasureKind::kArea};
  for (std::size_t i = 0; i < names.size(); ++i)
    json["kinds"][std::string(measure::row_of(names[i]).name)] = json_of(*others[i]);
  if (!judging.csv.empty())
    or_throw(output::write_file_atomically(
        judging.csv, csv_of({&distances, &planes, &heights, &angles, &areas})));
  return json;
}

}  // namespace hermite::commands
