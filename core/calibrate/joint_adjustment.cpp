#include "core/calibrate/joint_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/base/check.h"

namespace hermite::calibrate {
namespace {

// A bend of 1.5 % moves a camera by 7 to 9 cm and some 10 pixels within a few seconds; the error
// after a stage is well below the next stage's gate. The last gates are those of depth_links.h and
// of features with badly registered colour.
struct Stage {
  MeasurementGates gates;
  int step_count;
};
constexpr Stage kStages[] = {
    {{0.10, 30}, 3}, {{0.07, 20}, 3}, {{0.05, 12}, 3}, {{0.035, 8}, 3}, {{0.025, 6}, 6}};
constexpr std::size_t kFirstStageOfStarted = 2;
// A stage ends early when no pose moves by more [m, rad] and no camera parameter by a larger share
// of its deviation.
constexpr double kSettled = 1e-4, kSettledShare = 0.05;

// A weak prior holds poses where bare walls leave them undetermined: 1 m, 1 rad, and a ten
// thousandth of their information.
constexpr double kHeld = 1, kHeldShare = 1e-4;

// The twists of both views, then the camera.
constexpr Eigen::Index kPairNumberCount = 12 + kCameraNumberCount;
using PairVector = Eigen::Matrix<double, kPairNumberCount, 1>;
using PairMatrix = Eigen::Matrix<double, kPairNumberCount, kPairNumberCount>;

// The cost of a pair, both ways.
struct PairQuadratic {
  PairMatrix information = PairMatrix::Zero();
  PairVector gradient = PairVector::Zero();
};

// Offsets of the twists of source and target among a pair's parameters.
struct TwistOffsets {
  Eigen::Index source = 0, target = 6;
};

// Only the relative pose matters, so a twist of the target, expressed in the source, has the
// opposite effect of one of the source.
void add_side(const SideQuadratic& side, const Rigid3& target_from_source, TwistOffsets at,
              PairQuadratic& sum) {
  const Eigen::Matrix3d source_from_target =
      target_from_source.rotation.conjugate().toRotationMatrix();
  // Derivative of the source's twist by the target's: the adjoint of source_from_target.
  Eigen::Matrix<double, 6, 6> by_target = Eigen::Matrix<double, 6, 6>::Zero();
  by_target.topLeftCorner<3, 3>() = by_target.bottomRightCorner<3, 3>() = -source_from_target;
  by_target.topRightCorner<3, 3>() = source_from_target * skew(target_from_source.translation);
  Eigen::Matrix<double, kSideNumberCount, kPairNumberCount> spread =
      Eigen::Matrix<double, kSideNumberCount, kPairNumberCount>::Zero();
  spread.block<6, 6>(0, at.source).setIdentity();
  spread.block<6, 6>(0, at.target) = by_target;
  spread.bottomRightCorner<kCameraNumberCount, kCameraNumberCount>().setIdentity();
  const Eigen::Matrix<double, kSideNumberCount, kSideNumberCount> information =
      side.information.selfadjointView<Eigen::Lower>();
  sum.information += spread.transpose() * information * spread;
  sum.gradient += spread.transpose() * side.gradient;
}

// `matches`: of the corners of the pair's source in its target.
PairQuadratic quadratic_of(const ViewMeasurement& measurement, const PairSide& in_second,
                           const std::vector<adjust::LandmarkMatch>& matches,
                           const MeasurementGates& gates) {
  const PairSide in_first{in_second.target, in_second.source,
                          inverse(in_second.target_from_source)};
  SideQuadratic of_first, of_second;
  measurement.add_surfaces(in_second, gates.surface_m, of_first);
  measurement.add_surfaces(in_first, gates.surface_m, of_second);
  for (const adjust::LandmarkMatch& match : matches) {
    measurement.add_corner(in_second, match, gates.corner_px, of_first);
    measurement.add_corner(in_first, reversed(match), gates.corner_px, of_second);
  }
  PairQuadratic sum;
  add_side(of_first, in_second.target_from_source, {0, 6}, sum);
  add_side(of_second, in_first.target_from_source, {6, 0}, sum);
  return sum;
}

// The system of all pairs: six parameters per view, then the camera's.
struct System {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

System system_of(const std::vector<PairQuadratic>& measured, const std::vector<ViewPair>& pairs,
                 std::size_t view_count, const JointSolution& now, const JointOptions& options) {
  constexpr Eigen::Index kStarts[] = {0, 6, 12}, kSizes[] = {6, 6, kCameraNumberCount};
  const auto camera_at = static_cast<Eigen::Index>(6 * view_count),
             count = camera_at + static_cast<Eigen::Index>(kCameraNumberCount);
  System system{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairMatrix& information = measured[i].information;
    const Eigen::Index at[] = {6 * Eigen::Index{pairs[i].first}, 6 * Eigen::Index{pairs[i].second},
                               camera_at};
    for (int r = 0; r < 3; ++r) {
      system.gradient.segment(at[r], kSizes[r]) +=
          measured[i].gradient.segment(kStarts[r], kSizes[r]);
      for (int c = 0; c < 3; ++c)
        system.information.block(at[r], at[c], kSizes[r], kSizes[c]) +=
            information.block(kStarts[r], kStarts[c], kSizes[r], kSizes[c]);
    }
  }
  const auto fix = [&system](Eigen::Index at) {
    system.information.row(at).setZero();
    system.information.col(at).setZero();
    system.information(at, at) = 1;
    system.gradient[at] = 0;
  };
  for (Eigen::Index at = 0; at < 6; ++at) fix(at);
  for (Eigen::Index at = 6; at < camera_at; ++at)
    system.information(at, at) += kHeldShare * system.information(at, at) + kHeld;
  for (std::size_t k = 0; k < kCameraNumberCount; ++k) {
    const auto number = static_cast<Eigen::Index>(k), at = camera_at + number;
    if (!options.is_free[k]) {
      fix(at);
      continue;
    }
    const double prior = 1 / (options.prior_deviation[number] * options.prior_deviation[number]);
    system.information(at, at) += prior;
    system.gradient[at] += prior * now.change[number];
  }
  return system;
}

// See JointSolution::deviation. The sum of products over pairs with a common view is taken by view,
// minus the pairs themselves, which both of their views count. It is at least the scatter of single
// pairs.
CameraVector deviation_of(const std::vector<PairQuadratic>& measured,
                          const std::vector<ViewPair>& pairs, std::size_t view_count,
                          const Eigen::LDLT<Eigen::MatrixXd>& factor, const JointOptions& options) {
  const auto camera_at = static_cast<Eigen::Index>(6 * view_count);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(factor.rows(), kCameraNumberCount);
  unit.bottomRows<kCameraNumberCount>().setIdentity();
  const Eigen::MatrixXd covariance = factor.solve(unit);
  std::vector<CameraVector> by_view(view_count, CameraVector::Zero());
  CameraVector together = CameraVector::Zero(), by_pair = CameraVector::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairVector& gradient = measured[i].gradient;
    const CameraVector influence =
        covariance.middleRows<6>(6 * Eigen::Index{pairs[i].first}).transpose() *
            gradient.segment<6>(0) +
        covariance.middleRows<6>(6 * Eigen::Index{pairs[i].second}).transpose() *
            gradient.segment<6>(6) +
        covariance.middleRows<kCameraNumberCount>(camera_at).transpose() *
            gradient.tail<kCameraNumberCount>();
    by_view[pairs[i].first] += influence;
    by_view[pairs[i].second] += influence;
    by_pair += influence.cwiseAbs2();
  }
  for (const CameraVector& influence : by_view) together += influence.cwiseAbs2();
  CameraVector deviation = (together - by_pair).cwiseMax(by_pair).cwiseSqrt();
  for (std::size_t k = 0; k < kCameraNumberCount; ++k)
    if (!options.is_free[k]) deviation[static_cast<Eigen::Index>(k)] = 0;
  return deviation;
}

}  // namespace

JointSolution adjust_jointly(const std::vector<CalibrationView>& views,
                             const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options, const JointSolution* start) {
  for (const auto& [first, second] : pairs)
    CHECK(first < views.size() && second < views.size(),
          "a pair refers to a view that does not exist");
  JointSolution solution;
  for (const CalibrationView& view : views)
    solution.world_from_camera.push_back(view.world_from_camera);
  if (start != nullptr) {
    solution.world_from_camera = start->world_from_camera;
    for (std::size_t k = 0; k < kCameraNumberCount; ++k)
      if (options.is_free[k])
        solution.change[static_cast<Eigen::Index>(k)] = start->change[static_cast<Eigen::Index>(k)];
  }
  std::optional<ViewMeasurement> measurement;
  CameraVector measured_change;
  for (const Stage& stage :
       std::span(kStages).subspan(start != nullptr ? kFirstStageOfStarted : 0)) {
    std::vector<std::vector<adjust::LandmarkMatch>> matches(pairs.size());
    for (int step = 0; step < stage.step_count; ++step) {
      if (!measurement || measured_change != solution.change)
        measurement.emplace(views, changed(camera, solution.change), options.thread_count);
      measured_change = solution.change;
      std::vector<PairQuadratic> measured(pairs.size());
      for_all(pairs.size(), options.thread_count, [&](std::size_t i) {
        const Rigid3 second_from_first = inverse(solution.world_from_camera[pairs[i].second]) *
                                         solution.world_from_camera[pairs[i].first];
        const PairSide in_second{pairs[i].first, pairs[i].second, second_from_first};
        if (step == 0) matches[i] = measurement->corner_matches(in_second, stage.gates);
        measured[i] = quadratic_of(*measurement, in_second, matches[i], stage.gates);
      });
      const System system = system_of(measured, pairs, views.size(), solution, options);
      const Eigen::LDLT<Eigen::MatrixXd> factor(system.information);
      const Eigen::VectorXd twists = -factor.solve(system.gradient);
      for (std::size_t i = 0; i < views.size(); ++i)
        solution.world_from_camera[i] =
            solution.world_from_camera[i] *
            exp_se3(twists.segment<6>(static_cast<Eigen::Index>(6 * i)));
      const CameraVector step_of_camera = twists.tail<kCameraNumberCount>();
      solution.change += step_of_camera;
      solution.deviation = deviation_of(measured, pairs, views.size(), factor, options);
      const double moved =
          twists.head(twists.size() - Eigen::Index{kCameraNumberCount}).cwiseAbs().maxCoeff();
      if (moved < kSettled &&
          (step_of_camera.cwiseAbs().array() <= kSettledShare * solution.deviation.array()).all())
        break;
    }
  }
  return solution;
}

}  // namespace hermite::calibrate
