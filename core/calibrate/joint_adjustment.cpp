#include "core/calibrate/joint_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <thread>

#include "core/adjust/bundle_noise.h"
#include "core/base/check.h"
#include "core/calibrate/corner_matches.h"

namespace hermite {
namespace {

// A bend of 1.5 % moves a camera by 7 to 9 cm and some 10 pixels within a few seconds; the error after a stage is well below the next
// stage's gate. The last gates are those of depth_links.h and of features with badly registered colour.
struct Stage {
  double gate_m, gate_px;
  int step_count;
};
constexpr Stage kStages[] = {{0.10, 30, 3}, {0.07, 20, 3}, {0.05, 12, 3}, {0.035, 8, 3}, {0.025, 6, 6}};
constexpr std::size_t kFirstStageOfStarted = 2;
// A stage ends early when no pose moves by more [m, rad] and no camera parameter by a larger share of its deviation.
constexpr double kSettled = 1e-4, kSettledShare = 0.05;

// The step between a view's nodes in each direction: 12 pixels of 640, so that neighbouring windows hardly overlap.
constexpr int kEveryNode = 3;

// The scale of Cauchy's loss is a third of the gate, so a residual at the gate has a tenth of its weight.
constexpr double kGateOverScale = 3;
// A residual that noise explains is inside the gate, however narrow that is.
constexpr double kGateSigmas = 3;
constexpr double kLeastScale_px = 2;

constexpr float kAlikeCosine = 0.8f;  // of the normals of both sides, as in depth_links.cpp
constexpr float kBehind_m = 0.2f;

// A weak prior holds poses where bare walls leave them undetermined: 1 m, 1 rad, and a ten thousandth of their information.
constexpr double kHeld = 1, kHeldShare = 1e-4;

// Parameters of one side of a pair: a twist of the point's view in its own camera frame, and the camera's parameters.
constexpr Eigen::Index kSideNumberCount = 6 + kCameraNumberCount;
using SideVector = Eigen::Matrix<double, kSideNumberCount, 1>;

// Information matrix and gradient of the cost of one view's points against another view; the cost is half the quadratic form.
struct Quadratic {
  Eigen::Matrix<double, kSideNumberCount, kSideNumberCount> information =
      Eigen::Matrix<double, kSideNumberCount, kSideNumberCount>::Zero();  // only the lower half is set
  SideVector gradient = SideVector::Zero();
};

constexpr Eigen::Index kPairNumberCount = 12 + kCameraNumberCount;  // the twists of both views, then the camera
using PairVector = Eigen::Matrix<double, kPairNumberCount, 1>;
using PairMatrix = Eigen::Matrix<double, kPairNumberCount, kPairNumberCount>;
using PointByCamera = Eigen::Matrix<double, 3, kCameraNumberCount>;

// The cost of a pair, both ways.
struct PairQuadratic {
  PairMatrix information = PairMatrix::Zero();
  PairVector gradient = PairVector::Zero();
};

// Offsets of the twists of source and target among a pair's parameters.
struct TwistOffsets {
  Eigen::Index source = 0, target = 6;
};

// Only the relative pose matters, so a twist of the target, expressed in the source, has the opposite effect of one of the source.
void add_side(const Quadratic& side, const Rigid3& target_from_source, TwistOffsets at, PairQuadratic& sum) {
  const Eigen::Matrix3d source_from_target = target_from_source.rotation.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 6, 6> by_target = Eigen::Matrix<double, 6, 6>::Zero();  // of the source's twist: the adjoint of source_from_target
  by_target.topLeftCorner<3, 3>() = by_target.bottomRightCorner<3, 3>() = -source_from_target;
  by_target.topRightCorner<3, 3>() = source_from_target * skew(target_from_source.translation);
  Eigen::Matrix<double, kSideNumberCount, kPairNumberCount> spread = Eigen::Matrix<double, kSideNumberCount, kPairNumberCount>::Zero();
  spread.block<6, 6>(0, at.source).setIdentity();
  spread.block<6, 6>(0, at.target) = by_target;
  spread.bottomRightCorner<kCameraNumberCount, kCameraNumberCount>().setIdentity();
  const Eigen::Matrix<double, kSideNumberCount, kSideNumberCount> information = side.information.selfadjointView<Eigen::Lower>();
  sum.information += spread.transpose() * information * spread;
  sum.gradient += spread.transpose() * side.gradient;
}

// Calls work(i) for every i; thread t takes t, t + thread_count, ...
template <class Work>
void for_all(std::size_t count, unsigned thread_count, const Work& work) {
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < thread_count; ++t)
    threads.emplace_back([=, &work] {
      for (std::size_t i = t; i < count; i += thread_count) work(i);
    });
}

// Standard deviation [m] of a point on a plane, as in depth_links.cpp: the mean of a window's pixels, plus the error of tracking.
double deviation_m(double depth_m) { return kTracked_m + depth_deviation_m(depth_m) / 2; }

// Returns the derivative of a point measured at a pixel by the camera's parameters.
PointByCamera derivative_by_camera(const Eigen::Vector3d& point_m, const Eigen::Vector2d& pixel_px, const Camera& camera) {
  const double rho2 = camera.rho2(pixel_px.x(), pixel_px.y()), offset_per_m = camera.depth_correction.inverse_offset_per_m;
  const double scale = 1 + offset_per_m * kUndistortedDepth_m;
  PointByCamera derivative;
  derivative.col(kFocal) << -point_m.x(), -point_m.y(), 0;
  derivative.col(kCenterX) << -point_m.z() / camera.fx, 0, 0;
  derivative.col(kCenterY) << 0, -point_m.z() / camera.fy, 0;
  derivative.col(kBend) = point_m * (rho2 / (1 + camera.depth_correction.bend * rho2) * (1 - offset_per_m * point_m.z() / scale));
  derivative.col(kInverseOffset) = point_m * ((kUndistortedDepth_m - point_m.z()) / scale);
  return derivative;
}

// A point of the source that lies on a surface of the target.
struct Correspondence {
  Eigen::Vector3d in_source_m, in_target_m;
  Eigen::Vector2d source_px, target_px;
  Eigen::Vector3d normal_in_target;  // the source's
  double distance_m;                 // from the target's plane
  double sigma_m, gate_m;
};

// Distances between the surfaces of pairs.
struct Distances {
  std::vector<double> distances_m;  // absolute and clipped
  double squares = 0, depths_m = 0;
};

PairAgreement agreement_of(Distances distances) {
  if (distances.distances_m.empty()) return {};
  const auto middle = distances.distances_m.begin() + static_cast<std::ptrdiff_t>(distances.distances_m.size() / 2);
  std::nth_element(distances.distances_m.begin(), middle, distances.distances_m.end());
  const auto count = static_cast<double>(distances.distances_m.size());
  return {*middle, std::sqrt(distances.squares / count), distances.depths_m / count,
          static_cast<std::int64_t>(distances.distances_m.size())};
}

// All views with one trial camera.
class Measurement {
 public:
  Measurement(const std::vector<CalibrationView>& views, const Camera& camera, unsigned thread_count)
      : views_(views), camera_(camera), facets_(views.size()) {
    for_all(views.size(), thread_count, [this](std::size_t i) { facets_[i] = facets_of(views_[i].patches, camera_); });
  }

  // Visits correspondences of some nodes of the source with all nodes of the target.
  template <class Visit>
  void visit_correspondences(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, double gate_m,
                             const Visit& visit) const {
    const PatchGrid &from = views_[source].patches, &to = views_[target].patches;
    const Eigen::Matrix3f rotation = target_from_source.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f translation = target_from_source.translation.cast<float>();
    const Eigen::Array2f focal = Eigen::Array2d(camera_.fx, camera_.fy).cast<float>();
    const Eigen::Array2f center = Eigen::Array2d(camera_.cx, camera_.cy).cast<float>();
    for (int row = 1; row < from.nodes.height; row += kEveryNode)
      for (int column = 1; column < from.nodes.width; column += kEveryNode) {
        const Facet& facet = facets_[source][from.nodes.index(column, row)];
        if (facet.point_m.z() <= 0) continue;
        const Eigen::Vector3f point = rotation * facet.point_m + translation;
        if (point.z() < kBehind_m) continue;
        const Eigen::Array2f at = point.head<2>().array() / point.z() * focal + center;
        const Eigen::Array2f node = (at - static_cast<float>(to.step_px / 2)) / static_cast<float>(to.step_px) + 0.5f;
        if (!(node.x() >= 0 && node.y() >= 0 && node.x() < static_cast<float>(to.nodes.width) &&
              node.y() < static_cast<float>(to.nodes.height)))
          continue;
        const Facet& there = facets_[target][to.nodes.index(static_cast<int>(node.x()), static_cast<int>(node.y()))];
        if (there.point_m.z() <= 0) continue;
        const float length_per_m = there.plane_per_m.norm(), over_plane = there.plane_per_m.dot(point);
        if (!(over_plane > 0)) continue;
        const double distance_m = static_cast<double>((over_plane - 1) / length_per_m);
        const double behind_m = static_cast<double>(point.z() * (1 - 1 / over_plane));
        const double sigma_m = deviation_m(static_cast<double>(std::max(point.z(), facet.point_m.z())));
        const double near_m = std::max(gate_m, kGateSigmas * sigma_m);
        if (std::abs(distance_m) > near_m || std::abs(behind_m) > 2 * near_m) continue;
        const Eigen::Vector3f normal = rotation * facet.plane_per_m.normalized();
        if (normal.dot(there.plane_per_m) < kAlikeCosine * length_per_m) continue;
        visit(Correspondence{facet.point_m.cast<double>(), point.cast<double>(), Eigen::Vector2d(from.pixel_of(column), from.pixel_of(row)),
                             at.matrix().cast<double>(), normal.cast<double>(), distance_m, sigma_m, near_m});
      }
  }

  void add_surfaces(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, double gate_m, Quadratic& sum) const {
    const Eigen::Matrix3d source_from_target = target_from_source.rotation.conjugate().toRotationMatrix();
    visit_correspondences(source, target, target_from_source, gate_m, [&](const Correspondence& m) {
      const Eigen::Vector3d normal_in_source = source_from_target * m.normal_in_target;
      SideVector derivative;
      derivative.segment<3>(0) = normal_in_source;
      derivative.segment<3>(3) = m.in_source_m.cross(normal_in_source);
      // The camera moves both the point and the surface seen at its pixel.
      derivative.tail<kCameraNumberCount>() = derivative_by_camera(m.in_source_m, m.source_px, camera_).transpose() * normal_in_source -
                                              derivative_by_camera(m.in_target_m, m.target_px, camera_).transpose() * m.normal_in_target;
      const double off = m.distance_m * kGateOverScale / m.gate_m;
      const double weight = 1 / (m.sigma_m * m.sigma_m * (1 + off * off));
      sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative, weight);
      sum.gradient += weight * m.distance_m * derivative;
    });
  }

  void add_distances(const ViewPair& pair, const std::vector<Rigid3>& world_from_camera, Distances& sum) const {
    const auto visit = [&sum](const Correspondence& correspondence) {
      const double distance_m = std::min(std::abs(correspondence.distance_m), kMostCounted_m);
      sum.distances_m.push_back(distance_m);
      sum.squares += distance_m * distance_m;
      sum.depths_m += correspondence.in_target_m.z();
    };
    const Rigid3 second_from_first = inverse(world_from_camera[pair.second]) * world_from_camera[pair.first];
    visit_correspondences(pair.first, pair.second, second_from_first, kMostApart_m, visit);
    visit_correspondences(pair.second, pair.first, inverse(second_from_first), kMostApart_m, visit);
  }

  std::vector<LandmarkMatch> match(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, const Stage& stage) const {
    return match_corners(views_[source].features, views_[target].features, target_from_source, camera_, stage.gate_px, stage.gate_m);
  }

  // Adds the reprojection error of a corner of the source in the target.
  void add_corner(const Feature& seen, const Feature& there, const Rigid3& target_from_source, double gate_px, Quadratic& sum) const {
    const std::optional<Eigen::Vector3d> own = point_of(seen, camera_);
    if (!own) return;
    const Eigen::Vector3d point = target_from_source * *own;
    if (point.z() < static_cast<double>(kBehind_m)) return;
    const Eigen::Vector2d off_px = camera_.project(point) - there.pixel_px.cast<double>();
    const double sigma_px = std::max(octave_scale(seen.octave), octave_scale(there.octave));
    if (off_px.norm() > gate_px * sigma_px) return;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera_.fx / point.z(), 0, -camera_.fx * point.x() / (point.z() * point.z()),  //
        0, camera_.fy / point.z(), -camera_.fy * point.y() / (point.z() * point.z());
    const Eigen::Matrix<double, 2, 3> by_own = by_point * target_from_source.rotation.toRotationMatrix();
    Eigen::Matrix<double, 2, kSideNumberCount> derivative;
    derivative.leftCols<3>() = by_own;
    derivative.middleCols<3>(3) = -by_own * skew(*own);
    derivative.rightCols<kCameraNumberCount>() = by_own * derivative_by_camera(*own, seen.pixel_px.cast<double>(), camera_);
    derivative(0, 6 + kFocal) += camera_.fx * point.x() / point.z();
    derivative(1, 6 + kFocal) += camera_.fy * point.y() / point.z();
    derivative(0, 6 + kCenterX) += 1;
    derivative(1, 6 + kCenterY) += 1;
    const double scale_px = std::max(kLeastScale_px, gate_px / kGateOverScale) * sigma_px;
    const double weight = 1 / (sigma_px * sigma_px * (1 + off_px.squaredNorm() / (scale_px * scale_px)));
    sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative.transpose(), weight);
    sum.gradient += weight * derivative.transpose() * off_px;
  }

 private:
  const std::vector<CalibrationView>& views_;
  const Camera camera_;
  std::vector<std::vector<Facet>> facets_;  // by view
};

// The system of all pairs: six parameters per view, then the camera's.
struct System {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

System system_of(const std::vector<PairQuadratic>& measured, const std::vector<ViewPair>& pairs, std::size_t view_count,
                 const JointSolution& now, const JointOptions& options) {
  constexpr Eigen::Index kStarts[] = {0, 6, 12}, kSizes[] = {6, 6, kCameraNumberCount};
  const auto camera_at = static_cast<Eigen::Index>(6 * view_count), count = camera_at + static_cast<Eigen::Index>(kCameraNumberCount);
  System system{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairMatrix& information = measured[i].information;
    const Eigen::Index at[] = {6 * Eigen::Index{pairs[i].first}, 6 * Eigen::Index{pairs[i].second}, camera_at};
    for (int r = 0; r < 3; ++r) {
      system.gradient.segment(at[r], kSizes[r]) += measured[i].gradient.segment(kStarts[r], kSizes[r]);
      for (int c = 0; c < 3; ++c)
        system.information.block(at[r], at[c], kSizes[r], kSizes[c]) += information.block(kStarts[r], kStarts[c], kSizes[r], kSizes[c]);
    }
  }
  const auto fix = [&system](Eigen::Index at) {
    system.information.row(at).setZero();
    system.information.col(at).setZero();
    system.information(at, at) = 1;
    system.gradient[at] = 0;
  };
  for (Eigen::Index at = 0; at < 6; ++at) fix(at);
  for (Eigen::Index at = 6; at < camera_at; ++at) system.information(at, at) += kHeldShare * system.information(at, at) + kHeld;
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

// See JointSolution::deviation. The sum of products over pairs with a common view is taken by view, minus the pairs themselves, which
// both of their views count. It is at least the scatter of single pairs.
CameraVector deviation_of(const std::vector<PairQuadratic>& measured, const std::vector<ViewPair>& pairs, std::size_t view_count,
                          const Eigen::LDLT<Eigen::MatrixXd>& factor, const JointOptions& options) {
  const auto camera_at = static_cast<Eigen::Index>(6 * view_count);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(factor.rows(), kCameraNumberCount);
  unit.bottomRows<kCameraNumberCount>().setIdentity();
  const Eigen::MatrixXd covariance = factor.solve(unit);
  std::vector<CameraVector> by_view(view_count, CameraVector::Zero());
  CameraVector together = CameraVector::Zero(), by_pair = CameraVector::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairVector& gradient = measured[i].gradient;
    const CameraVector influence = covariance.middleRows<6>(6 * Eigen::Index{pairs[i].first}).transpose() * gradient.segment<6>(0) +
                                   covariance.middleRows<6>(6 * Eigen::Index{pairs[i].second}).transpose() * gradient.segment<6>(6) +
                                   covariance.middleRows<kCameraNumberCount>(camera_at).transpose() * gradient.tail<kCameraNumberCount>();
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

Camera changed(const Camera& camera, const CameraVector& change) {
  Camera result = camera;
  result.fx *= std::exp(change[kFocal]);
  result.fy *= std::exp(change[kFocal]);
  result.cx += change[kCenterX];
  result.cy += change[kCenterY];
  result.depth_correction.bend += change[kBend];
  result.depth_correction.inverse_offset_per_m += change[kInverseOffset];
  return result;
}

JointSolution adjust_jointly(const std::vector<CalibrationView>& views, const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options, const JointSolution* start) {
  for (const auto& [first, second] : pairs)
    CHECK(first < views.size() && second < views.size(), "a pair refers to a view that does not exist");
  JointSolution solution;
  for (const CalibrationView& view : views) solution.world_from_camera.push_back(view.world_from_camera);
  if (start != nullptr) {
    solution.world_from_camera = start->world_from_camera;
    for (std::size_t k = 0; k < kCameraNumberCount; ++k)
      if (options.is_free[k]) solution.change[static_cast<Eigen::Index>(k)] = start->change[static_cast<Eigen::Index>(k)];
  }
  std::optional<Measurement> measurement;
  CameraVector measured_change;
  for (const Stage& stage : std::span(kStages).subspan(start != nullptr ? kFirstStageOfStarted : 0)) {
    std::vector<std::vector<LandmarkMatch>> matches(pairs.size());
    for (int step = 0; step < stage.step_count; ++step) {
      if (!measurement || measured_change != solution.change)
        measurement.emplace(views, changed(camera, solution.change), options.thread_count);
      measured_change = solution.change;
      std::vector<PairQuadratic> measured(pairs.size());
      for_all(pairs.size(), options.thread_count, [&](std::size_t i) {
        const auto [first, second] = pairs[i];
        const Rigid3 second_from_first = inverse(solution.world_from_camera[second]) * solution.world_from_camera[first];
        const Rigid3 first_from_second = inverse(second_from_first);
        if (step == 0) matches[i] = measurement->match(first, second, second_from_first, stage);
        Quadratic of_first, of_second;
        measurement->add_surfaces(first, second, second_from_first, stage.gate_m, of_first);
        measurement->add_surfaces(second, first, first_from_second, stage.gate_m, of_second);
        for (const LandmarkMatch& match : matches[i]) {
          const Feature &in_first = views[first].features[match.landmark], &in_second = views[second].features[match.feature];
          measurement->add_corner(in_first, in_second, second_from_first, stage.gate_px, of_first);
          measurement->add_corner(in_second, in_first, first_from_second, stage.gate_px, of_second);
        }
        add_side(of_first, second_from_first, {0, 6}, measured[i]);
        add_side(of_second, first_from_second, {6, 0}, measured[i]);
      });
      const System system = system_of(measured, pairs, views.size(), solution, options);
      const Eigen::LDLT<Eigen::MatrixXd> factor(system.information);
      const Eigen::VectorXd twists = -factor.solve(system.gradient);
      for (std::size_t i = 0; i < views.size(); ++i)
        solution.world_from_camera[i] = solution.world_from_camera[i] * exp_se3(twists.segment<6>(static_cast<Eigen::Index>(6 * i)));
      const CameraVector step_of_camera = twists.tail<kCameraNumberCount>();
      solution.change += step_of_camera;
      solution.deviation = deviation_of(measured, pairs, views.size(), factor, options);
      const double moved = twists.head(twists.size() - Eigen::Index{kCameraNumberCount}).cwiseAbs().maxCoeff();
      if (moved < kSettled && (step_of_camera.cwiseAbs().array() <= kSettledShare * solution.deviation.array()).all()) break;
    }
  }
  return solution;
}

PairAgreement agreement_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& camera) {
  const Measurement measurement(views, camera, 1);
  Distances distances;
  for (const ViewPair& pair : pairs) measurement.add_distances(pair, world_from_camera, distances);
  return agreement_of(std::move(distances));
}

std::vector<PairAgreement> agreements_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                                         const std::vector<ViewPair>& pairs, const Camera& camera) {
  const Measurement measurement(views, camera, 1);
  std::vector<PairAgreement> agreements;
  for (const ViewPair& pair : pairs) {
    Distances distances;
    measurement.add_distances(pair, world_from_camera, distances);
    agreements.push_back(agreement_of(std::move(distances)));
  }
  return agreements;
}

}  // namespace hermite
