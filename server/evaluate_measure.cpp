#include "server/evaluate_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/base/printf_text.h"
#include "core/dataset/counted_random.h"
#include "core/dataset/text_file.h"
#include "core/evaluate/true_points.h"
#include "core/measure/measure.h"
#include "core/mesh/surfel_grid.h"
#include "core/output/ply.h"
#include "server/ply_file.h"
#include "server/result_files.h"

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

// A mesh is off by so much where one clicks on it (tests/accuracy/README.md, "Mesh").
constexpr double kPickDeviation_m = 0.002;

constexpr std::array kClassBounds_m{0.0, 0.5, 1.0, 2.0, 4.0, std::numeric_limits<double>::infinity()};

class Surfels {
 public:
  explicit Surfels(Cloud cloud) : cloud_(std::move(cloud)), grid_(kFitReach_m / SurfelGrid::kBinCells) {
    for (std::size_t i = 0; i < cloud_.size(); ++i) grid_.insert(static_cast<std::uint32_t>(i), cloud_[i].position_m);
  }

  Result<MeasuredPlace> fit(const Eigen::Vector3d& pick) const {
    std::vector<CloudPoint> around;
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(static_cast<float>(kFitReach_m));
    grid_.for_each(pick.cast<float>() - reach, pick.cast<float>() + reach, [&](std::uint32_t slot) { around.push_back(cloud_[slot]); });
    return fit_surface_point(around, pick);
  }

 private:
  Cloud cloud_;
  SurfelGrid grid_;
};

struct JudgedPoint {
  TruePoint truth;
  MeasuredPlace found;
};

struct JudgedPair {
  double true_m = 0;
  Distance found;
  bool is_inside() const { return std::abs(found.distance_m - true_m) <= found.half_width_m; }
};

// None: nothing can be measured there.
std::vector<std::optional<JudgedPoint>> judged_points(const std::vector<TruePoint>& points, const Surfels& surfels, std::uint64_t seed) {
  std::vector<std::optional<JudgedPoint>> judged;
  for (std::size_t i = 0; i < points.size(); ++i) {
    judged.emplace_back();
    const Result<MeasuredPlace> there = surfels.fit(points[i].estimated_m);
    if (!there.ok()) continue;
    const double off_m = kPickDeviation_m * normal_pair(frame_key(seed, -1), i).a;
    const Result<MeasuredPlace> found = surfels.fit(points[i].estimated_m + off_m * there->normal);
    if (found.ok()) judged.back() = JudgedPoint{points[i], *found};
  }
  return judged;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Json summary_of(const std::vector<JudgedPair>& pairs, double from_m, double to_m) {
  std::vector<double> half_widths, errors;
  std::size_t inside = 0;
  for (const JudgedPair& pair : pairs) {
    if (pair.true_m < from_m || pair.true_m >= to_m) continue;
    half_widths.push_back(pair.found.half_width_m);
    errors.push_back(std::abs(pair.found.distance_m - pair.true_m));
    inside += pair.is_inside();
  }
  Json summary{{"pairs", errors.size()}};
  if (errors.empty()) return summary;
  summary["inside"] = static_cast<double>(inside) / static_cast<double>(errors.size());
  summary["median_half_width_m"] = median_of(half_widths);
  summary["median_error_m"] = median_of(errors);
  return summary;
}

std::string csv_of(const std::vector<JudgedPair>& pairs) {
  std::string text = "true_m,measured_m,half_width_m,surface_sigma_m,pose_sigma_m,way_m\n";
  for (const JudgedPair& pair : pairs)
    text += printf_text("%.6f,%.6f,%.6f,%.6f,%.6f,%.3f\n", pair.true_m, pair.found.distance_m, pair.found.half_width_m,
                        pair.found.surface_sigma_m, pair.found.pose_sigma_m, pair.found.way_m);
  return text;
}

}  // namespace

Json evaluate_measure(const MeasureJudging& judging) {
  const ResultFiles files = or_throw(read_result_files(judging.result));
  const MapKnowledge map = or_throw(map_knowledge_of(files.trajectory_text, files.report_json));
  const std::unique_ptr<Sequence> sequence = or_throw(open_sequence(judging.sequence));
  const Trajectory estimate = or_throw(parse_tum_trajectory(files.trajectory_text));
  const auto wanted = static_cast<std::size_t>(judging.pairs);
  // A quarter more than are needed, for those that nothing can be measured at.
  const std::vector<TruePoint> points = or_throw(true_points(*sequence, estimate, wanted * 5 / 2, judging.seed));
  const Surfels surfels(cloud_of(read_ply_file(judging.result + "/surfels.ply")));
  const std::vector<std::optional<JudgedPoint>> judged = judged_points(points, surfels, judging.seed);
  std::vector<JudgedPair> pairs;
  std::size_t tried = 0;
  for (std::size_t i = 1; i < judged.size() && pairs.size() < wanted; i += 2, ++tried) {
    if (!judged[i - 1] || !judged[i]) continue;
    const Result<Distance> distance = distance_between(judged[i - 1]->found, judged[i]->found, map);
    if (distance.ok()) pairs.push_back({(judged[i - 1]->truth.true_m - judged[i]->truth.true_m).norm(), *distance});
  }
  Json json = summary_of(pairs, 0, std::numeric_limits<double>::infinity());
  json["tried"] = tried;
  json["refused"] = 1 - static_cast<double>(pairs.size()) / static_cast<double>(std::max<std::size_t>(1, tried));
  json["half_width_at_1m_m"] = summary_of(pairs, 0.9, 1.1).value("median_half_width_m", 0.0);
  for (std::size_t i = 1; i < kClassBounds_m.size(); ++i) {
    Json one = summary_of(pairs, kClassBounds_m[i - 1], kClassBounds_m[i]);
    one["from_m"] = kClassBounds_m[i - 1];
    json["classes"].push_back(one);
  }
  if (!judging.csv.empty()) or_throw(write_file_atomically(judging.csv, csv_of(pairs)));
  return json;
}

}  // namespace hermite
