#include "core/calibrate/pair_agreement.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace hermite::calibrate {
namespace {

// Of at least one value, whose order it changes.
double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rms_of(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

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
    const auto count = static_cast<std::int64_t>(distances_m_.size());
    return {median_of(distances_m_), rms_of(distances_m_), median_of(along_rays_),
            rms_of(along_rays_), count};
  }

 private:
  void add(const std::vector<SurfaceMatch>& matches) {
    for (const SurfaceMatch& match : matches) {
      distances_m_.push_back(std::min(std::abs(match.distance_m), kMostCounted_m));
      along_rays_.push_back(std::min(std::abs(match.behind_m), kMostCounted_m) /
                            match.in_target_m.z());
    }
  }

  // Absolute and clipped; along rays, relative to depth.
  std::vector<double> distances_m_, along_rays_;
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

std::vector<double> squares_of(const std::vector<PairAgreement>& agreements) {
  std::vector<double> squares;
  for (const PairAgreement& agreement : agreements)
    squares.push_back(agreement.relative_rms * agreement.relative_rms);
  return squares;
}

std::vector<double> squares_of(const std::vector<CornerReprojection>& agreements) {
  std::vector<double> squares;
  for (const CornerReprojection& agreement : agreements)
    squares.push_back(agreement.rms_px * agreement.rms_px);
  return squares;
}

}  // namespace hermite::calibrate
