#include "core/track/corner_split.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/frame_helpers.h"
#include "core/track/reprojection.h"

namespace hermite::track {

namespace {

constexpr std::size_t kLeastCornersOfMotion = 12;
// A corner whose error exceeds this many standard deviations does not follow the motion; its cost
// is constant beyond, so that wrongly followed corners have bounded influence.
constexpr double kBeyond = 4;
// To count as moving on its own, its error must also exceed this share of its displacement by the
// camera's motion, because corners slide along edges, and rolling shutters and lenses shift them in
// the direction of motion.
constexpr double kShareOfCamera = 0.4;
constexpr int kFitSteps = 6, kRounds = 4;
// A corner represents a surface area that grows with the square of its distance. The weight is
// bounded because very far depth is hardly measured.
constexpr double kNearestWeight_m = 0.5, kFarthestWeight_m = 4;
// Weight of corners that moved a moment ago, which are unlikely to belong to the room now.
constexpr double kMovedBeforeWeight = 0.25;
// Prior of the motion between two frames, in effect for directions that the corners do not
// determine: a camera moves by decimetres and turns by tenths of a radian.
constexpr double kPriorMove_m = 0.3, kPriorTurn_rad = 0.5;
constexpr double kInFront_m = 0.05;

using Chosen = std::vector<std::uint8_t>;

struct Problem {
  const std::vector<FollowedCorner>& corners;
  const Camera& camera;
  double precision_px;
  std::vector<double> weight;

  double error_px(std::size_t i, const Rigid3& frame_from_earlier) const {
    const Eigen::Vector3d p = frame_from_earlier * corners[i].point_in_earlier;
    if (p.z() < kInFront_m) return 1e3;
    return (camera.project(p) - corners[i].pixel).norm();
  }

  // Returns how far the camera's motion moves the corner in the image if the corner rests.
  double way_px(std::size_t i, const Rigid3& frame_from_earlier) const {
    const Eigen::Vector3d p = frame_from_earlier * corners[i].point_in_earlier;
    return p.z() < kInFront_m
               ? 0
               : (camera.project(p) - camera.project(corners[i].point_in_earlier)).norm();
  }

  // Robust Gauss-Newton fit to the chosen corners; errors beyond `scale_px` are increasingly
  // down-weighted.
  Rigid3 fit(const Chosen& chosen, Rigid3 frame_from_earlier, double scale_px) const {
    for (int step = 0; step < kFitSteps; ++step) {
      NormalEquations system = motion_prior(kPriorMove_m, kPriorTurn_rad);
      const Eigen::Matrix3d rotation = frame_from_earlier.rotation.toRotationMatrix();
      for (std::size_t i = 0; i < corners.size(); ++i) {
        if (chosen[i] == 0) continue;
        const Eigen::Vector3d p =
            rotation * corners[i].point_in_earlier + frame_from_earlier.translation;
        if (p.z() < kInFront_m) continue;
        const Eigen::Vector2d error = camera.project(p) - corners[i].pixel;
        add_reprojection(system, camera, p, error,
                         1 / (scale_px * scale_px + error.squaredNorm() / 5));
      }
      const Vector6d move = system.hessian.ldlt().solve(system.right_hand_side);
      frame_from_earlier = exp_se3(move) * frame_from_earlier;
      if (move.norm() < 1e-6) break;
    }
    return frame_from_earlier;
  }

  Chosen near(const Rigid3& frame_from_earlier) const {
    Chosen result(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i)
      result[i] = error_px(i, frame_from_earlier) < kBeyond * precision_px ? 1 : 0;
    return result;
  }

  // Robust cost of a motion: lowest for the one that explains most surface best.
  double cost(const Rigid3& frame_from_earlier) const {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i)
      sum += weight[i] * std::min(std::pow(error_px(i, frame_from_earlier) / precision_px, 2),
                                  kBeyond * kBeyond);
    return sum;
  }
};

std::size_t count(const Chosen& chosen) {
  return static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), std::uint8_t{1}));
}

// Returns subsets of the corners that may be free of moving objects: those beyond a certain depth,
// and those outside a range of columns or rows.
std::vector<Chosen> parts_of(const std::vector<FollowedCorner>& corners,
                             const std::vector<std::uint8_t>& moved_before) {
  const std::size_t n = corners.size();
  std::vector<Chosen> parts{Chosen(n, 1)};
  if (moved_before.size() == n) {
    parts.emplace_back(n);
    for (std::size_t i = 0; i < n; ++i) parts.back()[i] = moved_before[i] != 0 ? 0 : 1;
  }
  const auto by_rank = [&](auto key, double from, double to, bool inside) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return key(corners[a]) < key(corners[b]);
    });
    Chosen part(n, inside ? 0 : 1);
    for (auto rank = static_cast<std::size_t>(from * static_cast<double>(n));
         rank < static_cast<std::size_t>(to * static_cast<double>(n)); ++rank)
      part[order[rank]] = inside ? 1 : 0;
    parts.push_back(std::move(part));
  };
  const auto depth = [](const FollowedCorner& c) { return c.point_in_earlier.z(); };
  const auto column = [](const FollowedCorner& c) { return c.pixel.x(); };
  const auto row = [](const FollowedCorner& c) { return c.pixel.y(); };
  for (const double nearer : {0.15, 0.3, 0.45, 0.6}) by_rank(depth, 0, nearer, false);
  for (const double start : {0.0, 0.2, 0.4, 0.6}) by_rank(column, start, start + 0.4, false);
  for (const double start : {0.0, 0.3, 0.6}) by_rank(row, start, start + 0.4, false);
  return parts;
}

// Returns the motion of a part's corners and of all other corners that follow it.
Rigid3 motion_of(const Problem& problem, const Chosen& part) {
  // Fits from coarse to fine: errors of tens of pixels first, then the precision of corner
  // tracking.
  Rigid3 motion =
      problem.fit(part, problem.fit(part, {}, 20 * problem.precision_px), 3 * problem.precision_px);
  Chosen chosen;
  for (int round = 0; round < kRounds; ++round) {
    Chosen near = problem.near(motion);
    if (near == chosen || count(near) < kLeastCornersOfMotion) break;
    motion = problem.fit(near, motion, problem.precision_px);
    chosen = std::move(near);
  }
  return motion;
}

// Returns the motion of least cost, the first of equal ones; std::nullopt if all parts are too
// small.
std::optional<Rigid3> best_motion(const Problem& problem, const std::vector<Chosen>& parts) {
  struct Candidate {
    std::optional<Rigid3> motion;
    double cost = 0;
  };
  std::vector<Candidate> candidates(parts.size());
  in_parallel_of_frame(parts.size(), [&](std::size_t i) {
    if (count(parts[i]) < kLeastCornersOfMotion) return;
    const Rigid3 motion = motion_of(problem, parts[i]);
    candidates[i] = {motion, problem.cost(motion)};
  });
  Candidate best;
  for (const Candidate& candidate : candidates)
    if (candidate.motion && (!best.motion || candidate.cost < best.cost)) best = candidate;
  return best.motion;
}

}  // namespace

std::optional<CornerSplit> split_corners(const std::vector<FollowedCorner>& corners,
                                         const std::vector<std::uint8_t>& moved_before,
                                         const Camera& camera, double precision_px) {
  if (corners.size() < kLeastCornersOfMotion) return std::nullopt;
  Problem problem{corners, camera, precision_px, {}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double depth_m =
        std::clamp(corners[i].point_in_earlier.z(), kNearestWeight_m, kFarthestWeight_m);
    const bool moved = moved_before.size() == corners.size() && moved_before[i] != 0;
    problem.weight.push_back(depth_m * depth_m * (moved ? kMovedBeforeWeight : 1));
  }
  const std::optional<Rigid3> best = best_motion(problem, parts_of(corners, moved_before));
  if (!best) return std::nullopt;
  CornerSplit split{inverse(*best), 0, {}, {}, 0};
  double all = 0, moving = 0, squares = 0;
  std::size_t resting = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double error = problem.error_px(i, *best);
    const bool rests = error < kBeyond * precision_px;
    const bool moves = !rests && error > kShareOfCamera * problem.way_px(i, *best);
    split.error_px.push_back(error);
    split.moves.push_back(moves ? 1 : 0);
    all += problem.weight[i];
    moving += moves ? problem.weight[i] : 0;
    squares += rests ? error * error : 0;
    resting += rests ? 1 : 0;
  }
  split.moving_share = moving / all;
  if (resting < kLeastCornersOfMotion || split.moving_share > 0.5) return std::nullopt;
  split.deviation_px = std::sqrt(squares / static_cast<double>(2 * resting));
  return split;
}

}  // namespace hermite::track
