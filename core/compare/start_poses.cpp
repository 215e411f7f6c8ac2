#include "core/compare/start_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>

#include "core/base/parallel.h"

namespace hermite::compare {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Lengths are in spacings of samples. The two pairs of a draw must be some spacings apart, or the
// errors of their normals turn the rest too far.
constexpr double kLeastSpan = 6, kSpanTolerance = 1.2, kCosineTolerance = 0.25;
constexpr double kInlier = 2.4, kInlierCosine = 0.85;
constexpr int kDraws = 300'000;
constexpr std::size_t kMostHypotheses = 4000;
constexpr double kQuickReach = 2.4;
constexpr std::size_t kQuickSamples = 400;

struct OrientedPair {
  const SurfaceSample *first, *second;
};

std::optional<Matrix3d> frame_of(const OrientedPair& pair) {
  const Vector3d x = (pair.second->position_m - pair.first->position_m).normalized();
  Vector3d y = pair.first->normal - x * x.dot(pair.first->normal);
  if (y.norm() < 0.3) y = pair.second->normal - x * x.dot(pair.second->normal);
  if (y.norm() < 0.3) return std::nullopt;
  Matrix3d frame;
  frame << x, y.normalized(), x.cross(y.normalized());
  return frame;
}

bool are_alike(const OrientedPair& a, const OrientedPair& b, double spacing_m) {
  const Vector3d span_a = a.second->position_m - a.first->position_m,
                 span_b = b.second->position_m - b.first->position_m;
  const double length_a = span_a.norm(), length_b = span_b.norm();
  if (std::min(length_a, length_b) < kLeastSpan * spacing_m ||
      std::abs(length_a - length_b) > kSpanTolerance * spacing_m)
    return false;
  const auto agree = [](double x, double y) { return std::abs(x - y) < kCosineTolerance; };
  return agree(a.first->normal.dot(a.second->normal), b.first->normal.dot(b.second->normal)) &&
         agree(a.first->normal.dot(span_a) / length_a, b.first->normal.dot(span_b) / length_b) &&
         agree(a.second->normal.dot(span_a) / length_a, b.second->normal.dot(span_b) / length_b);
}

std::optional<Rigid3> transform_between(const OrientedPair& a, const OrientedPair& b,
                                        double spacing_m) {
  if (!are_alike(a, b, spacing_m)) return std::nullopt;
  // Both frames must take their second axis from the same normal: with similar cosines they do.
  const std::optional<Matrix3d> frame_a = frame_of(a), frame_b = frame_of(b);
  if (!frame_a || !frame_b) return std::nullopt;
  Rigid3 a_from_b{Eigen::Quaterniond(*frame_a * frame_b->transpose()).normalized(),
                  Vector3d::Zero()};
  const Vector3d middle_a = (a.first->position_m + a.second->position_m) / 2,
                 middle_b = (b.first->position_m + b.second->position_m) / 2;
  a_from_b.translation = middle_a - a_from_b.rotation * middle_b;
  if ((a_from_b.rotation * b.first->normal).dot(a.first->normal) < kInlierCosine)
    return std::nullopt;
  if ((a_from_b.rotation * b.second->normal).dot(a.second->normal) < kInlierCosine)
    return std::nullopt;
  return a_from_b;
}

Vector3d middle_of(std::span<const SurfaceSample> samples) {
  Vector3d sum = Vector3d::Zero();
  for (const SurfaceSample& sample : samples) sum += sample.position_m;
  return samples.empty() ? sum : Vector3d(sum / static_cast<double>(samples.size()));
}

struct Scored {
  std::size_t score = 0;
  Rigid3 a_from_b;
};

std::vector<Rigid3> best_different(std::vector<Scored> scored, const CoarseScan& b,
                                   std::size_t most) {
  std::stable_sort(scored.begin(), scored.end(),
                   [](const Scored& x, const Scored& y) { return x.score > y.score; });
  std::vector<Rigid3> kept;
  for (const Scored& candidate : scored) {
    if (kept.size() == most) break;
    const bool is_known = std::any_of(kept.begin(), kept.end(), [&](const Rigid3& k) {
      return is_same_pose(k, candidate.a_from_b, b);
    });
    if (!is_known) kept.push_back(candidate.a_from_b);
  }
  return kept;
}

// The direction that most of the surface faces, to either side, among those perpendicular to
// `other` if there is one.
Vector3d main_direction(std::span<const SurfaceSample> samples,
                        const std::optional<Vector3d>& other) {
  const std::size_t stride = samples.size() / 500 + 1;
  Vector3d best = other ? other->unitOrthogonal() : Vector3d::UnitZ();
  std::size_t most = 0;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    const Vector3d& normal = samples[i].normal;
    if (other && std::abs(normal.dot(*other)) > 0.15) continue;
    std::size_t count = 0;
    for (std::size_t j = 0; j < samples.size(); j += stride)
      count += std::abs(samples[j].normal.dot(normal)) > 0.985 ? 1 : 0;
    if (count > most) {
      most = count;
      best = normal;
    }
  }
  return other ? Vector3d((best - *other * other->dot(best)).normalized()) : best;
}

// Columns are the main directions, right-handed.
Matrix3d main_directions(std::span<const SurfaceSample> samples) {
  const Vector3d first = main_direction(samples, std::nullopt),
                 second = main_direction(samples, first);
  Matrix3d directions;
  directions << first, second, first.cross(second);
  return directions;
}

// The 24 rotations that map coordinate axes to coordinate axes.
std::vector<Matrix3d> axis_rotations() {
  std::vector<Matrix3d> rotations;
  for (int first = 0; first < 6; ++first)
    for (int second = 0; second < 6; ++second) {
      if (first / 2 == second / 2) continue;
      const Vector3d x = (first % 2 ? -1.0 : 1.0) * Vector3d::Unit(first / 2),
                     y = (second % 2 ? -1.0 : 1.0) * Vector3d::Unit(second / 2);
      Matrix3d rotation;
      rotation << x, y, x.cross(y);
      rotations.push_back(rotation);
    }
  return rotations;
}

// How much surface faces along a direction, by its position along it.
struct Profile {
  static constexpr int kBins = 1024;  // 51 m with samples 5 cm apart; farther surfaces are left out
  std::vector<float> forward = std::vector<float>(kBins), backward = std::vector<float>(kBins);
};

Profile profile_of(std::span<const SurfaceSample> samples, const Vector3d& direction,
                   double middle_m, double bin_m) {
  Profile profile;
  for (const SurfaceSample& sample : samples) {
    const double cosine = sample.normal.dot(direction);
    const int bin =
        static_cast<int>(std::floor((sample.position_m.dot(direction) - middle_m) / bin_m)) +
        Profile::kBins / 2;
    if (std::abs(cosine) < 0.9 || bin < 0 || bin >= Profile::kBins) continue;
    (cosine > 0 ? profile.forward : profile.backward)[static_cast<std::size_t>(bin)] += 1;
  }
  return profile;
}

double overlap_of(const Profile& a, const Profile& b, int shift) {
  double sum = 0;
  for (int bin = std::max(0, shift); bin < std::min(Profile::kBins, Profile::kBins + shift);
       ++bin) {
    const auto in_a = static_cast<std::size_t>(bin), in_b = static_cast<std::size_t>(bin - shift);
    sum += std::sqrt(a.forward[in_a] * b.forward[in_b]) +
           std::sqrt(a.backward[in_a] * b.backward[in_b]);
  }
  return sum;
}

// The shifts of B along the direction by which most surfaces fall together, and which are not
// beside a better one.
std::vector<double> best_shifts_m(const Profile& a, const Profile& b, double bin_m) {
  constexpr std::size_t kShifts = 3;
  constexpr int kReach = 240;  // bins
  std::vector<std::pair<double, int>> overlaps;
  for (int shift = -kReach; shift <= kReach; ++shift)
    overlaps.emplace_back(-overlap_of(a, b, shift), shift);
  std::sort(overlaps.begin(), overlaps.end());
  std::vector<double> shifts_m;
  std::vector<int> taken;
  for (const auto& [overlap, shift] : overlaps) {
    if (taken.size() == kShifts || overlap == 0) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [shift = shift](int other) { return std::abs(other - shift) < 4; }))
      continue;
    taken.push_back(shift);
    shifts_m.push_back(shift * bin_m);
  }
  if (shifts_m.empty()) shifts_m.push_back(0);
  return shifts_m;
}

}  // namespace

bool is_same_pose(const Rigid3& a_from_b, const Rigid3& other_a_from_b, const CoarseScan& b) {
  const Vector3d middle_b = middle_of(b.samples());
  return (a_from_b * middle_b - other_a_from_b * middle_b).norm() < kSamePlace * b.spacing_m() &&
         angle_rad(a_from_b.rotation.conjugate() * other_a_from_b.rotation) < kSameTurn_rad;
}

std::vector<Rigid3> poses_by_features(const CoarseScan& scan_a, const CoarseScan& scan_b,
                                      std::span<const FeaturePair> pairs, std::size_t most) {
  if (pairs.size() < 2) return {};
  const std::span<const SurfaceSample> a = scan_a.samples(), b = scan_b.samples();
  const double spacing_m = std::max(scan_a.spacing_m(), scan_b.spacing_m()),
               inlier2_m2 = std::pow(kInlier * spacing_m, 2);
  std::mt19937 random(1);
  std::vector<Rigid3> hypotheses;
  for (int draw = 0; draw < kDraws && hypotheses.size() < kMostHypotheses; ++draw) {
    const FeaturePair &first = pairs[random() % pairs.size()],
                      &second = pairs[random() % pairs.size()];
    const std::optional<Rigid3> a_from_b =
        transform_between({&a[first.sample_a], &a[second.sample_a]},
                          {&b[first.sample_b], &b[second.sample_b]}, spacing_m);
    if (a_from_b) hypotheses.push_back(*a_from_b);
  }
  std::vector<Scored> scored(hypotheses.size());
  in_parallel(hypotheses.size(), [&](std::size_t i) {
    scored[i] = {0, hypotheses[i]};
    const Matrix3d rotation = hypotheses[i].rotation.toRotationMatrix();
    for (const FeaturePair& pair : pairs) {
      const SurfaceSample &in_a = a[pair.sample_a], &in_b = b[pair.sample_b];
      const bool agrees =
          (rotation * in_b.position_m + hypotheses[i].translation - in_a.position_m).squaredNorm() <
              inlier2_m2 &&
          (rotation * in_b.normal).dot(in_a.normal) > kInlierCosine;
      scored[i].score += agrees ? 1 : 0;
    }
  });
  return best_different(std::move(scored), scan_b, most);
}

std::vector<Rigid3> poses_by_planes(const CoarseScan& scan_a, const CoarseScan& scan_b) {
  const std::span<const SurfaceSample> a = scan_a.samples(), b = scan_b.samples();
  const double bin_m = std::max(scan_a.spacing_m(), scan_b.spacing_m());
  const Matrix3d directions_a = main_directions(a), directions_b = main_directions(b);
  const Vector3d middle_a = middle_of(a), middle_b = middle_of(b);
  std::vector<Rigid3> poses;
  for (const Matrix3d& rotation : axis_rotations()) {
    const Matrix3d a_from_b = directions_a * rotation * directions_b.transpose();
    std::array<std::vector<double>, 3> shifts_m;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d in_a = directions_a.col(axis), in_b = a_from_b.transpose() * in_a;
      shifts_m[static_cast<std::size_t>(axis)] =
          best_shifts_m(profile_of(a, in_a, middle_a.dot(in_a), bin_m),
                        profile_of(b, in_b, middle_b.dot(in_b), bin_m), bin_m);
    }
    for (const double x : shifts_m[0])
      for (const double y : shifts_m[1])
        for (const double z : shifts_m[2])
          poses.push_back({Eigen::Quaterniond(a_from_b).normalized(),
                           middle_a + directions_a * Vector3d(x, y, z) - a_from_b * middle_b});
  }
  return poses;
}

std::vector<Rigid3> best_poses(const CoarseScan& a, const CoarseScan& scan_b,
                               std::span<const Rigid3> candidates, std::size_t most) {
  const std::span<const SurfaceSample> b = scan_b.samples();
  const double reach_m = kQuickReach * std::max(a.spacing_m(), scan_b.spacing_m());
  std::vector<Scored> scored(candidates.size());
  const std::size_t stride = b.size() / kQuickSamples + 1;
  in_parallel(candidates.size(), [&](std::size_t i) {
    scored[i] = {0, candidates[i]};
    for (std::size_t j = 0; j < b.size(); j += stride)
      scored[i].score +=
          a.grid().nearest(candidates[i] * b[j].position_m, candidates[i].rotation * b[j].normal,
                           reach_m, kInlierCosine)
              ? 1
              : 0;
  });
  return best_different(std::move(scored), scan_b, most);
}

std::vector<Rigid3> turned_poses(const Rigid3& a_from_b, const CoarseScan& scan_a) {
  const std::span<const SurfaceSample> a = scan_a.samples();
  const Matrix3d directions = main_directions(a);
  Vector3d low = Vector3d::Constant(1e30), high = -low;
  for (const SurfaceSample& sample : a) {
    low = low.cwiseMin(directions.transpose() * sample.position_m);
    high = high.cwiseMax(directions.transpose() * sample.position_m);
  }
  const Vector3d middle = directions * ((low + high) / 2);
  std::vector<Rigid3> poses;
  for (int axis = 0; axis < 3; ++axis)
    for (int quarter = 1; quarter < 4; ++quarter) {
      const Eigen::Quaterniond turn(
          Eigen::AngleAxisd(quarter * M_PI / 2, Vector3d(directions.col(axis))));
      poses.push_back(Rigid3{turn, middle - turn * middle} * a_from_b);
    }
  return poses;
}

}  // namespace hermite::compare
