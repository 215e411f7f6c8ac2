#include "core/calibrate/joint_adjustment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <thread>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/projection_match.h"

namespace hermite {
namespace {

constexpr int kPairNumbers = 12 + kCameraNumbers;  // the twists of both views, then the camera
using PairVector = Eigen::Matrix<double, kPairNumbers, 1>;
using PairMatrix = Eigen::Matrix<double, kPairNumbers, kPairNumbers>;
using PointByCamera = Eigen::Matrix<double, 3, kCameraNumbers>;

struct Stage {
  double gate_m, gate_px;
  int steps;
};
constexpr Stage kStages[] = {{0.10, 30, 3}, {0.07, 20, 3}, {0.05, 12, 3}, {0.035, 8, 4}, {0.025, 6, 6}};

constexpr float kAlikeCosine = 0.8f;

struct Quadratic {
  PairMatrix information = PairMatrix::Zero();
  PairVector gradient = PairVector::Zero();
  std::int64_t points = 0, corners = 0;
};

double deviation_m(double depth_m) { return kTracked_m + depth_deviation_m(depth_m) / 2; }

// Of a point that is measured at a pixel with a depth.
PointByCamera derivative_by_camera(const Eigen::Vector3d& point, double rho2, const Camera& camera) {
  PointByCamera derivative;
  derivative.col(kFocal) << -point.x(), -point.y(), 0;
  derivative.col(kCenterX) << -point.z() / camera.fx, 0, 0;
  derivative.col(kCenterY) << 0, -point.z() / camera.fy, 0;
  derivative.col(kBend) = point * (rho2 / (1 + camera.depth_distortion.bend * rho2));
  derivative.col(kInverseOffset) = -point * point.z();
  return derivative;
}

struct Placed {
  std::vector<Facet> facets;
};

class Measurement {
 public:
  Measurement(const std::vector<CalibrationView>& views, const Camera& camera, unsigned thread_count)
      : views_(views), camera_(camera), facets_(views.size()) {
    parallel(views.size(), thread_count, [&](std::size_t i) { facets_[i] = facets_of(views[i].patches, camera); });
  }

  template <class Work>
  static void parallel(std::size_t count, unsigned thread_count, Work work) {
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < thread_count; ++t)
      threads.emplace_back([=] {
        for (std::size_t i = t; i < count; i += thread_count) work(i);
      });
    for (std::thread& thread : threads) thread.join();
  }

  // visit(facet of the source, its pixel, the point in the target's camera, the plane there, the pixel there, distance)
  template <class Visit>
  void each_meeting(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, double gate_m, Visit visit) const {
    const PatchGrid& from = views_[source].patches;
    const PatchGrid& to = views_[target].patches;
    const Eigen::Matrix3f rotation = target_from_source.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f translation = target_from_source.translation.cast<float>();
    const float fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
    const float cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
    const float per_step = 1.0f / static_cast<float>(to.step_px), first_px = static_cast<float>(to.step_px / 2);
    for (int row = 1; row < from.nodes.height; row += 2)
      for (int column = 1; column < from.nodes.width; column += 2) {
        const Facet& facet = facets_[source][from.nodes.index(column, row)];
        if (facet.point_m.z() <= 0) continue;
        const Eigen::Vector3f point = rotation * facet.point_m + translation;
        if (point.z() < static_cast<float>(kNearestPatch_m) / 2) continue;
        const float u = point.x() / point.z() * fx + cx, v = point.y() / point.z() * fy + cy;
        const float x = (u - first_px) * per_step + 0.5f, y = (v - first_px) * per_step + 0.5f;
        if (!(x >= 0 && y >= 0 && x < static_cast<float>(to.nodes.width) && y < static_cast<float>(to.nodes.height))) continue;
        const Facet& there = facets_[target][to.nodes.index(static_cast<int>(x), static_cast<int>(y))];
        if (there.point_m.z() <= 0) continue;
        const float length = there.plane_per_m.norm(), over_plane = there.plane_per_m.dot(point);
        const float distance_m = (over_plane - 1) / length;
        const float far = std::max(point.z(), facet.point_m.z());
        const double sigma_m = deviation_m(static_cast<double>(far));
        const double near_m = std::max(gate_m, 3 * sigma_m);
        if (!(std::abs(distance_m) <= static_cast<float>(near_m)) || !(over_plane > 0.5f)) continue;
        if (std::abs(point.z() * (1 - 1 / over_plane)) > 2 * static_cast<float>(near_m)) continue;
        const Eigen::Vector3f normal = rotation * facet.plane_per_m.normalized();
        if (normal.dot(there.plane_per_m) < kAlikeCosine * length) continue;
        visit(facet.point_m, Eigen::Vector2d(from.pixel_of(column), from.pixel_of(row)), point, normal, Eigen::Vector2d(u, v),
              static_cast<double>(distance_m), sigma_m, near_m);
      }
  }

  // The order of a pair's numbers, the twist of the source first; or second when `swapped`.
  void add_surface(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, double gate_m, bool swapped,
                   Quadratic& sum) const {
    const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
    const int from = swapped ? 6 : 0, to = swapped ? 0 : 6;
    each_meeting(source, target, target_from_source, gate_m,
                 [&](const Eigen::Vector3f& source_point, const Eigen::Vector2d& source_px, const Eigen::Vector3f& moved,
                     const Eigen::Vector3f& normal_f, const Eigen::Vector2d& target_px, double distance_m, double sigma_m, double near_m) {
                   const Eigen::Vector3d own = source_point.cast<double>(), point = moved.cast<double>(), normal = normal_f.cast<double>();
                   const Eigen::Vector3d back = rotation.transpose() * normal;
                   PairVector derivative;
                   derivative.segment<3>(from) = back;
                   derivative.segment<3>(from + 3) = own.cross(back);
                   derivative.segment<3>(to) = -normal;
                   derivative.segment<3>(to + 3) = -point.cross(normal);
                   derivative.tail<kCameraNumbers>() =
                       derivative_by_camera(own, camera_.rho2(source_px.x(), source_px.y()), camera_).transpose() * back -
                       derivative_by_camera(point, camera_.rho2(target_px.x(), target_px.y()), camera_).transpose() * normal;
                   const double scale_m = near_m / 3;
                   const double weight = 1 / (sigma_m * sigma_m * (1 + distance_m * distance_m / (scale_m * scale_m)));
                   sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative, weight);
                   sum.gradient += weight * distance_m * derivative;
                   ++sum.points;
                 });
  }

  // The corrected point of a feature.
  std::optional<Eigen::Vector3d> point_of(const Feature& feature) const {
    if (feature.depth_m <= 0) return std::nullopt;
    const double u = static_cast<double>(feature.pixel_px.x()), v = static_cast<double>(feature.pixel_px.y());
    const double depth_m = camera_.depth_distortion.true_depth_m(static_cast<double>(feature.depth_m), camera_.rho2(u, v));
    if (!(depth_m > 0)) return std::nullopt;
    return camera_.unproject(u, v, depth_m);
  }

  std::vector<LandmarkMatch> match(std::uint32_t source, std::uint32_t target, const Rigid3& target_from_source, const Stage& stage) const {
    constexpr double kBin_px = 32;
    const std::vector<Feature>&of_source = views_[source].features, &of_target = views_[target].features;
    const int columns = static_cast<int>(camera_.width / kBin_px) + 1, rows = static_cast<int>(camera_.height / kBin_px) + 1;
    std::vector<std::vector<std::uint32_t>> bins(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const auto bin = [&](int column, int row) { return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column); };
    for (std::uint32_t i = 0; i < of_target.size(); ++i)
      bins[bin(static_cast<int>(of_target[i].pixel_px.x() / kBin_px), static_cast<int>(of_target[i].pixel_px.y() / kBin_px))].push_back(i);
    std::vector<LandmarkMatch> matches;
    for (std::uint32_t i = 0; i < of_source.size(); ++i) {
      const std::optional<Eigen::Vector3d> own = point_of(of_source[i]);
      if (!own) continue;
      const Eigen::Vector3d point = target_from_source * *own;
      if (point.z() < kNearestPatch_m / 2) continue;
      const Eigen::Vector2d at = camera_.project(point);
      if (!(at.x() >= 0 && at.y() >= 0 && at.x() < camera_.width && at.y() < camera_.height)) continue;
      int best = 65, second = 257;
      std::uint32_t best_index = 0;
      const int left = std::max(0, static_cast<int>((at.x() - stage.gate_px) / kBin_px));
      const int right = std::min(columns - 1, static_cast<int>((at.x() + stage.gate_px) / kBin_px));
      const int top = std::max(0, static_cast<int>((at.y() - stage.gate_px) / kBin_px));
      const int bottom = std::min(rows - 1, static_cast<int>((at.y() + stage.gate_px) / kBin_px));
      for (int row = top; row <= bottom; ++row)
        for (int column = left; column <= right; ++column)
          for (const std::uint32_t j : bins[bin(column, row)]) {
            const Feature& candidate = of_target[j];
            if (std::abs(int{candidate.octave} - int{of_source[i].octave}) > 2) continue;
            if ((candidate.pixel_px.cast<double>() - at).norm() > stage.gate_px) continue;
            if (candidate.depth_m > 0) {
              const std::optional<Eigen::Vector3d> there = point_of(candidate);
              if (!there || std::abs(there->z() - point.z()) > 2 * stage.gate_m + 3 * depth_deviation_m(point.z())) continue;
            }
            const int distance = hamming(candidate.descriptor, of_source[i].descriptor);
            if (distance < best) {
              second = best;
              best = distance;
              best_index = j;
            } else if (distance < second) {
              second = distance;
            }
          }
      if (best <= 64 && best <= 0.8 * second) matches.push_back({best_index, i, best});
    }
    return one_to_one(std::move(matches));
  }

  void add_corner(const Feature& seen, const Feature& there, const Rigid3& target_from_source, double gate_px, bool swapped,
                  Quadratic& sum) const {
    const std::optional<Eigen::Vector3d> own = point_of(seen);
    if (!own) return;
    const Eigen::Vector3d point = target_from_source * *own;
    if (point.z() < kNearestPatch_m / 2) return;
    const Eigen::Vector2d off = camera_.project(point) - there.pixel_px.cast<double>();
    const double sigma_px = std::max(octave_scale(seen.octave), octave_scale(there.octave));
    if (off.norm() > gate_px * sigma_px) return;
    const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
    const int from = swapped ? 6 : 0, to = swapped ? 0 : 6;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera_.fx / point.z(), 0, -camera_.fx * point.x() / (point.z() * point.z()), 0, camera_.fy / point.z(),
        -camera_.fy * point.y() / (point.z() * point.z());
    const double rho2 = camera_.rho2(static_cast<double>(seen.pixel_px.x()), static_cast<double>(seen.pixel_px.y()));
    Eigen::Matrix<double, 2, kPairNumbers> derivative;
    const Eigen::Matrix<double, 2, 3> by_own = by_point * rotation;
    derivative.middleCols<3>(from) = by_own;
    derivative.middleCols<3>(from + 3) = -by_own * skew(*own);
    derivative.middleCols<3>(to) = -by_point;
    derivative.middleCols<3>(to + 3) = by_point * skew(point);
    derivative.rightCols<kCameraNumbers>() = by_own * derivative_by_camera(*own, rho2, camera_);
    derivative(0, 12 + kFocal) += camera_.fx * point.x() / point.z();
    derivative(1, 12 + kFocal) += camera_.fy * point.y() / point.z();
    derivative(0, 12 + kCenterX) += 1;
    derivative(1, 12 + kCenterY) += 1;
    const double scale_px = std::max(2.0, gate_px / 3) * sigma_px;
    const double weight = 1 / (sigma_px * sigma_px * (1 + off.squaredNorm() / (scale_px * scale_px)));
    sum.information.selfadjointView<Eigen::Lower>().rankUpdate(derivative.transpose(), weight);
    sum.gradient += weight * derivative.transpose() * off;
    ++sum.corners;
  }

 private:
  const std::vector<CalibrationView>& views_;
  const Camera camera_;
  std::vector<std::vector<Facet>> facets_;
};

}  // namespace

Camera changed(const Camera& camera, const CameraVector& change) {
  Camera result = camera;
  result.fx *= std::exp(change[kFocal]);
  result.fy *= std::exp(change[kFocal]);
  result.cx += change[kCenterX];
  result.cy += change[kCenterY];
  result.depth_distortion.bend += change[kBend];
  result.depth_distortion.inverse_offset_per_m += change[kInverseOffset];
  return result;
}

JointSolution adjust_jointly(const std::vector<CalibrationView>& views, const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options) {
  JointSolution solution;
  for (const CalibrationView& view : views) solution.world_from_camera.push_back(view.world_from_camera);
  const auto numbers = static_cast<Eigen::Index>(6 * views.size() + kCameraNumbers), first_camera = static_cast<Eigen::Index>(6 * views.size());
  const bool trace = std::getenv("CAL_TRACE") != nullptr;
  for (const Stage& stage : kStages) {
    std::vector<std::vector<LandmarkMatch>> matches(pairs.size());
    for (int step = 0; step < stage.steps; ++step) {
      const Camera now = changed(camera, solution.change);
      const Measurement measurement(views, now, options.thread_count);
      std::vector<Quadratic> measured(pairs.size());
      Measurement::parallel(pairs.size(), options.thread_count, [&](std::size_t i) {
        const auto [a, b] = pairs[i];
        const Rigid3 b_from_a = inverse(solution.world_from_camera[b]) * solution.world_from_camera[a], a_from_b = inverse(b_from_a);
        if (step == 0) matches[i] = measurement.match(a, b, b_from_a, stage);
        measurement.add_surface(a, b, b_from_a, stage.gate_m, false, measured[i]);
        measurement.add_surface(b, a, a_from_b, stage.gate_m, true, measured[i]);
        for (const LandmarkMatch& match : matches[i]) {
          const Feature &in_a = views[a].features[match.landmark], &in_b = views[b].features[match.feature];
          measurement.add_corner(in_a, in_b, b_from_a, stage.gate_px, false, measured[i]);
          measurement.add_corner(in_b, in_a, a_from_b, stage.gate_px, true, measured[i]);
        }
      });
      Eigen::MatrixXd information = Eigen::MatrixXd::Zero(numbers, numbers);
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(numbers);
      std::int64_t points = 0, corners = 0;
      std::vector<std::array<Eigen::Index, 3>> starts;
      constexpr int kLocal[] = {0, 6, 12}, kSizes[] = {6, 6, kCameraNumbers};
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        Quadratic& m = measured[i];
        m.information.triangularView<Eigen::StrictlyUpper>() = m.information.transpose();
        points += m.points;
        corners += m.corners;
        const std::array<Eigen::Index, 3> at{6 * static_cast<Eigen::Index>(pairs[i].first), 6 * static_cast<Eigen::Index>(pairs[i].second), first_camera};
        for (std::size_t r = 0; r < 3; ++r) {
          gradient.segment(at[r], kSizes[r]) += m.gradient.segment(kLocal[r], kSizes[r]);
          for (std::size_t c = 0; c < 3; ++c)
            information.block(at[r], at[c], kSizes[r], kSizes[c]) += m.information.block(kLocal[r], kLocal[c], kSizes[r], kSizes[c]);
        }
      }
      // The first view stays; every other one is held a little where it was.
      for (Eigen::Index i = 0; i < first_camera; ++i) information(i, i) += i < 6 ? 1e12 : 1e-4 * information(i, i) + 1;
      for (std::size_t k = 0; k < kCameraNumbers; ++k) {
        const Eigen::Index at = first_camera + static_cast<Eigen::Index>(k);
        const auto n = static_cast<Eigen::Index>(k);
        if (options.is_free[k]) {
          const double prior = 1 / (options.prior_deviation[n] * options.prior_deviation[n]);
          information(at, at) += prior;
          gradient[at] += prior * solution.change[n];
        } else {
          information.row(at).setZero();
          information.col(at).setZero();
          information(at, at) = 1;
          gradient[at] = 0;
        }
      }
      const Eigen::LDLT<Eigen::MatrixXd> factor(information);
      const Eigen::VectorXd delta = -factor.solve(gradient);
      // covariance
      Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(numbers, kCameraNumbers);
      unit.bottomRows<kCameraNumbers>().setIdentity();
      const Eigen::MatrixXd columns = factor.solve(unit);
      std::vector<CameraVector> by_view(views.size(), CameraVector::Zero());
      CameraMatrix spread = CameraMatrix::Zero(), by_pair = CameraMatrix::Zero();
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        CameraVector y = columns.middleRows<6>(6 * pairs[i].first).transpose() * measured[i].gradient.segment<6>(0) +
                         columns.middleRows<6>(6 * pairs[i].second).transpose() * measured[i].gradient.segment<6>(6) +
                         columns.bottomRows<kCameraNumbers>().transpose() * measured[i].gradient.tail<kCameraNumbers>();
        by_view[pairs[i].first] += y;
        by_view[pairs[i].second] += y;
        by_pair += y * y.transpose();
      }
      for (const CameraVector& y : by_view) spread += y * y.transpose();
      const CameraMatrix model = columns.bottomRows<kCameraNumbers>();
      for (std::size_t i = 0; i < views.size(); ++i) solution.world_from_camera[i] = solution.world_from_camera[i] * exp_se3(delta.segment<6>(static_cast<Eigen::Index>(6 * i)));
      solution.change += delta.tail<kCameraNumbers>();
      solution.covariance = spread - by_pair;
      if (trace) {
        std::fprintf(stderr, "gate %.3f points %lld corners %lld  f %+.3f%% cx %+.2f cy %+.2f bend %+.3f%% off %+.4f | model", stage.gate_m,
                     static_cast<long long>(points), static_cast<long long>(corners), 100 * solution.change[0], solution.change[1],
                     solution.change[2], 100 * solution.change[3], solution.change[4]);
        const double unit_of[] = {100, 1, 1, 100, 1};
        for (int k = 0; k < 5; ++k) std::fprintf(stderr, " %.4f", unit_of[k] * std::sqrt(model(k, k)));
        std::fprintf(stderr, " | dyadic");
        for (int k = 0; k < 5; ++k) std::fprintf(stderr, " %.4f", unit_of[k] * std::sqrt(std::max(0.0, solution.covariance(k, k))));
        std::fprintf(stderr, " | pair");
        for (int k = 0; k < 5; ++k) std::fprintf(stderr, " %.4f", unit_of[k] * std::sqrt(by_pair(k, k)));
        std::fprintf(stderr, "\n");
      }
    }
  }
  return solution;
}

PairAgreement agreement_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& camera) {
  const Measurement measurement(views, camera, 2);
  std::vector<double> distances;
  double squares = 0;
  constexpr double kCut_m = 0.05;
  for (const auto& [a, b] : pairs) {
    const Rigid3 b_from_a = inverse(world_from_camera[b]) * world_from_camera[a];
    const auto visit = [&](const Eigen::Vector3f&, const Eigen::Vector2d&, const Eigen::Vector3f&, const Eigen::Vector3f&, const Eigen::Vector2d&,
                           double distance_m, double, double) {
      const double cut = std::min(std::abs(distance_m), kCut_m);
      distances.push_back(cut);
      squares += cut * cut;
    };
    measurement.each_meeting(a, b, b_from_a, 0.10, visit);
    measurement.each_meeting(b, a, inverse(b_from_a), 0.10, visit);
  }
  if (distances.empty()) return {};
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return {*middle, std::sqrt(squares / static_cast<double>(distances.size())), static_cast<std::int64_t>(distances.size())};
}

}  // namespace hermite
