#include "core/thumbnail/up_direction.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace hermite::thumbnail {

namespace {

// The viewer judges alike in web/src/scene/gravity.ts.
constexpr std::size_t kMostSamples = 4000, kFewestSamples = 300;
constexpr double kLeastRange_rad = 0.05, kRangeDeviations = 3;
// Step between candidates: half of what they are judged by.
constexpr float kStep_rad = 0.09f;
constexpr float kCoarse_rad = 0.17f;
// Then the plane itself, noise included.
constexpr std::array<float, 3> kFine_rad = {0.14f, 0.09f, 0.06f};
// A lamp or a ceiling says less than a floor.
constexpr float kCeilingWorth = 0.5f;
// A direction along some wall is easily found.
constexpr float kWallWorth = 0.35f;
// This share of the surface lies across or along the direction, or it is no room.
constexpr float kEnough = 0.3f;
constexpr float kEnoughAcross = 0.03f;

using Normals = std::vector<Eigen::Vector3f>;

Normals some_normals(const output::Cloud& cloud) {
  Normals normals;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kMostSamples);
  for (std::size_t i = 0; i < cloud.size(); i += step)
    if (cloud[i].normal.squaredNorm() > 0.5f) normals.push_back(cloud[i].normal);
  return normals;
}

// Shares of the surface: facing a direction, facing away, and along it.
struct Support {
  float floor = 0, ceiling = 0, walls = 0;
};

Support support_of(const Normals& normals, const Eigen::Vector3f& up, float within_rad) {
  const float across = std::cos(within_rad), along = std::sin(within_rad);
  std::size_t floor = 0, ceiling = 0, walls = 0;
  for (const Eigen::Vector3f& normal : normals) {
    const float cosine = normal.dot(up);
    if (cosine > across)
      ++floor;
    else if (cosine < -across)
      ++ceiling;
    else if (std::abs(cosine) < along)
      ++walls;
  }
  const auto share = [&normals](std::size_t count) {
    return static_cast<float>(count) / static_cast<float>(normals.size());
  };
  return {share(floor), share(ceiling), share(walls)};
}

// Directions on a cone of rings around the middle of the range.
std::vector<Eigen::Vector3f> candidates(const UpRange& range) {
  const Eigen::Quaternionf from_upright =
      Eigen::Quaternionf::FromTwoVectors(UpRange().middle, range.middle);
  std::vector<Eigen::Vector3f> all{range.middle};
  for (float tilt_rad = kStep_rad; tilt_rad < range.most_off_rad; tilt_rad += kStep_rad) {
    const int count =
        static_cast<int>(std::ceil(2 * std::numbers::pi_v<float> * std::sin(tilt_rad) / kStep_rad));
    for (int i = 0; i < count; ++i) {
      const float turn_rad =
          2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
      all.push_back(from_upright * Eigen::Vector3f(std::sin(tilt_rad) * std::cos(turn_rad),
                                                   -std::cos(tilt_rad),
                                                   std::sin(tilt_rad) * std::sin(turn_rad)));
    }
  }
  return all;
}

// Returns the direction that the floors and ceilings around `up` face best and the walls lie along
// best: the eigenvector of the smallest eigenvalue of the sum of n n^T over walls less that over
// floors and ceilings.
Eigen::Vector3f refined(const Normals& normals, const Eigen::Vector3f& up, float within_rad) {
  const float across = std::cos(within_rad), along = std::sin(within_rad);
  Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
  for (const Eigen::Vector3f& normal : normals) {
    const float cosine = std::abs(normal.dot(up));
    if (cosine > across)
      sum -= normal * normal.transpose();
    else if (cosine < along)
      sum += normal * normal.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(sum);
  const Eigen::Vector3f axis = solver.eigenvectors().col(0);
  return axis.dot(up) < 0 ? Eigen::Vector3f(-axis) : axis;
}

}  // namespace

UpRange up_range(const std::optional<UpDirection>& measured) {
  if (!measured) return {};
  const auto off_rad =
      static_cast<float>(std::max(kLeastRange_rad, kRangeDeviations * measured->sigma_rad));
  return {measured->in_world.cast<float>(), std::min(UpRange().most_off_rad, off_rad)};
}

std::optional<Eigen::Vector3f> up_direction(const output::Cloud& cloud, const UpRange& range) {
  const Normals normals = some_normals(cloud);
  if (normals.size() < kFewestSamples) return std::nullopt;
  const Eigen::Vector3f& held = range.middle;
  Eigen::Vector3f best = held;
  float best_score = 0;
  for (const Eigen::Vector3f& candidate : candidates(range)) {
    const Support support = support_of(normals, candidate, kCoarse_rad);
    const float cosine = candidate.dot(held);
    const float score =
        (support.floor + kCeilingWorth * support.ceiling + kWallWorth * support.walls) * cosine *
        cosine;
    if (score <= best_score) continue;
    best = candidate;
    best_score = score;
  }
  if (best_score == 0) return std::nullopt;
  for (const float within_rad : kFine_rad) best = refined(normals, best, within_rad);
  const Support support = support_of(normals, best, kCoarse_rad);
  const float across = support.floor + support.ceiling;
  if (best.dot(held) < std::cos(range.most_off_rad) || across + support.walls < kEnough ||
      across < kEnoughAcross)
    return std::nullopt;
  return best;
}

Eigen::Vector3f best_up(const output::Cloud& cloud, const std::optional<UpDirection>& measured) {
  const UpRange range = up_range(measured);
  return up_direction(cloud, range).value_or(range.middle);
}

}  // namespace hermite::thumbnail
