#include "core/calibrate/pair_agreement.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace hermite::calibrate {
namespace {

class SurfaceSum {
 public:
  void add(const ViewMeasurement& measurement, const std::vector<Rigid3>& world_from_camera,
           const ViewPair& pair) {
    const Rigid3 second_from_first =
        inverse(world_from_camera[pair.second]) * world_from_camera[pair.first];
    add(measurement.surface_matches({pair.first, pair.second, second_from_first}, kMostApart_m));
    add(measurement.surface_matches({pair.second, pair.first, inverse(second_from_first)},
                                    kMostApart_m));
  }

  PairAgreement agreement() && {
    if (distances_m_.empty()) return {};
    const auto middle = distances_m_.begin() + static_cast<std::ptrdiff_t>(distances_m_.size() / 2);
    std::nth_element(distances_m_.begin(), middle, distances_m_.end());
    const auto count = static_cast<double>(distances_m_.size());
    return {*middle, std::sqrt(squares_ / count), depths_m_ / count,
            static_cast<std::int64_t>(distances_m_.size())};
  }

 private:
  void add(const std::vector<SurfaceMatch>& matches) {
    for (const SurfaceMatch& match : matches) {
      const double distance_m = std::min(std::abs(match.distance_m), kMostCounted_m);
      distances_m_.push_back(distance_m);
      squares_ += distance_m * distance_m;
      depths_m_ += match.in_target_m.z();
    }
  }

  std::vector<double> distances_m_;  // absolute and clipped
  double squares_ = 0, depths_m_ = 0;
};

class CornerSum {
 public:
  void add(const ViewMeasurement& measurement, const std::vector<Rigid3>& world_from_camera,
           const ViewPair& pair) {
    const Rigid3 second_from_first =
        inverse(world_from_camera[pair.second]) * world_from_camera[pair.first];
    const double scale = measurement.camera().width / 640.0;
    for (const Eigen::Vector2d& error_px : measurement.corner_errors_px(
             {pair.first, pair.second, second_from_first}, {kMostApart_m, kMostApart_px * scale})) {
      const double counted_px = std::min(error_px.norm() / scale, kMostCounted_px);
      squares_ += counted_px * counted_px;
      ++count_;
    }
  }

  CornerReprojection agreement() && {
    if (count_ == 0) return {};
    return {std::sqrt(squares_ / static_cast<double>(count_)), count_};
  }

 private:
  double squares_ = 0;
  std::int64_t count_ = 0;
};

template <class Sum>
auto sums_of(const std::vector<CalibrationView>& views,
             const std::vector<Rigid3>& world_from_camera, const std::vector<ViewPair>& pairs,
             const Camera& trial) {
  const ViewMeasurement measurement(views, trial, 1);
  std::vector<decltype(Sum().agreement())> agreements;
  for (const ViewPair& pair : pairs) {
    Sum sum;
    sum.add(measurement, world_from_camera, pair);
    agreements.push_back(std::move(sum).agreement());
  }
  return agreements;
}

}  // namespace

PairAgreement agreement_of(const std::vector<CalibrationView>& views,
                           const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& trial) {
  const ViewMeasurement measurement(views, trial, 1);
  SurfaceSum sum;
  for (const ViewPair& pair : pairs) sum.add(measurement, world_from_camera, pair);
  return std::move(sum).agreement();
}

std::vector<PairAgreement> agreements_of(const std::vector<CalibrationView>& views,
                                         const std::vector<Rigid3>& world_from_camera,
                                         const std::vector<ViewPair>& pairs, const Camera& trial) {
  return sums_of<SurfaceSum>(views, world_from_camera, pairs, trial);
}

std::vector<CornerReprojection> corner_reprojections_of(
    const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
    const std::vector<ViewPair>& pairs, const Camera& trial) {
  return sums_of<CornerSum>(views, world_from_camera, pairs, trial);
}

PairGain gain_of(const std::vector<double>& squares_before,
                 const std::vector<double>& squares_after) {
  CHECK(squares_before.size() == squares_after.size(), "the same pairs before and after");
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < squares_before.size(); ++i) {
    if (!(squares_before[i] > 0 && squares_after[i] > 0)) continue;
    const double gain = 1 - squares_after[i] / squares_before[i];
    sum += gain;
    squares += gain * gain;
    ++count;
  }
  if (count < 2) return {};
  const double mean = sum / count, variance = std::max(0.0, squares / count - mean * mean);
  return {mean, std::sqrt(variance / (count - 1)), static_cast<std::size_t>(count)};
}

PairGain gain_of(const HeldOutPairs& held_out, const JointSolution& before,
                 const JointSolution& after, ShowsIn where) {
  const auto squares = [&](const JointSolution& solution) {
    const Camera camera = changed(held_out.camera, solution.change);
    const std::vector<Rigid3>& poses = solution.world_from_camera;
    return where == ShowsIn::kCorners
               ? squares_of(corner_reprojections_of(held_out.views, poses, held_out.pairs, camera))
               : squares_of(agreements_of(held_out.views, poses, held_out.pairs, camera));
  };
  return gain_of(squares(before), squares(after));
}

// Relative to depth, so that a camera that shrinks everything gains nothing.
std::vector<double> squares_of(const std::vector<PairAgreement>& agreements) {
  std::vector<double> squares;
  for (const PairAgreement& agreement : agreements)
    squares.push_back(
        agreement.point_count > 0 ? std::pow(agreement.rms_m / agreement.mean_depth_m, 2) : 0);
  return squares;
}

std::vector<double> squares_of(const std::vector<CornerReprojection>& agreements) {
  std::vector<double> squares;
  for (const CornerReprojection& agreement : agreements)
    squares.push_back(agreement.rms_px * agreement.rms_px);
  return squares;
}

}  // namespace hermite::calibrate
