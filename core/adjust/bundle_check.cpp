#include "core/adjust/bundle_check.h"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

namespace hermite::adjust {

namespace {

// Bounds far beyond any real scan, which keep every square finite.
constexpr double kFarthest_m = 1e6;
constexpr double kLargestPixel_px = 1e6;
constexpr double kLeastScale = 1e-3, kLargestScale = 1e3;
constexpr double kLargestInformation = 1e18;  // corresponds to a nanometre or a nanoradian
// Quaternions of poses composed in double precision have unit length to 1e-15; those that went
// through single precision, to 1e-7.
constexpr double kUnitTolerance = 1e-6;
// Relative to the largest entry or eigenvalue: how symmetric and definite an information matrix is
// after sums and inverses in double precision.
constexpr double kInformationTolerance = 1e-9;
constexpr int kMostIterations = 1000;

Error bad(const std::string& list, std::size_t index, const std::string& message) {
  return {ErrorCode::kInvalidArgument, fmt::format("{}[{}]{}", list, index, message)};
}

// Returns what is wrong with the pose, or nullopt.
std::optional<std::string> problem_with(const Rigid3& pose) {
  if (!is_finite(pose)) return " is not finite";
  if (std::abs(pose.rotation.norm() - 1) > kUnitTolerance)
    return " is not a rotation: its quaternion does not have length 1";
  if (pose.translation.cwiseAbs().maxCoeff() > kFarthest_m) return " lies more than 1e6 m away";
  return std::nullopt;
}

std::optional<std::string> problem_with(const Matrix6d& information) {
  if (!information.allFinite()) return " is not finite";
  const double largest = information.cwiseAbs().maxCoeff();
  if (largest > kLargestInformation) return " is above 1e18";
  if ((information - information.transpose()).cwiseAbs().maxCoeff() >
      kInformationTolerance * largest)
    return " is not symmetric";
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information, Eigen::EigenvaluesOnly);
  if (solver.eigenvalues().minCoeff() < -kInformationTolerance * largest)
    return " is not positive semi-definite";
  return std::nullopt;
}

// Written so that NaN fails too.
bool within(double value, double low, double high) { return value >= low && value <= high; }

Status validate_lists(const BundleProblem& problem) {
  if (problem.is_fixed.size() != problem.world_from_submap.size())
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("is_fixed has {} entries for {} submaps", problem.is_fixed.size(),
                             problem.world_from_submap.size())};
  for (std::size_t i = 0; i < problem.world_from_submap.size(); ++i)
    if (const auto message = problem_with(problem.world_from_submap[i]))
      return bad("world_from_submap", i, *message);
  for (std::size_t i = 0; i < problem.keyframes.size(); ++i) {
    if (problem.keyframes[i].submap >= problem.world_from_submap.size())
      return bad("keyframes", i,
                 fmt::format(".submap is {}, but there are {} submaps", problem.keyframes[i].submap,
                             problem.world_from_submap.size()));
    if (const auto message = problem_with(problem.keyframes[i].submap_from_camera))
      return bad("keyframes", i, ".submap_from_camera" + *message);
    const double weight = problem.keyframes[i].weight;
    if (!(weight > 0 && weight <= 1))
      return bad("keyframes", i,
                 fmt::format(".weight is {:f}, allowed is above 0 and at most 1", weight));
  }
  for (std::size_t i = 0; i < problem.landmarks_in_world.size(); ++i)
    if (!(problem.landmarks_in_world[i].cwiseAbs().maxCoeff() <= kFarthest_m) ||
        !problem.landmarks_in_world[i].allFinite())
      return bad("landmarks_in_world", i, " is not finite or lies more than 1e6 m away");
  return Done{};
}

Status validate_observations(const BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    if (observation.keyframe >= problem.keyframes.size())
      return bad("observations", i,
                 fmt::format(".keyframe is {}, but there are {} keyframes", observation.keyframe,
                             problem.keyframes.size()));
    if (observation.landmark >= problem.landmarks_in_world.size())
      return bad("observations", i,
                 fmt::format(".landmark is {}, but there are {} landmarks", observation.landmark,
                             problem.landmarks_in_world.size()));
    for (const double pixel : {observation.pixel_px.x(), observation.pixel_px.y()})
      if (!within(pixel, -kLargestPixel_px, kLargestPixel_px))
        return bad("observations", i, ".pixel_px is not finite or its magnitude is above 1e6");
    if (!within(observation.depth_m, 0, kFarthest_m))
      return bad("observations", i, ".depth_m is outside [0, 1e6]");
    if (!within(observation.scale, kLeastScale, kLargestScale))
      return bad("observations", i, ".scale is outside [0.001, 1000]");
  }
  return Done{};
}

Status validate_links(const BundleProblem& problem) {
  const std::size_t submap_count = problem.world_from_submap.size();
  for (std::size_t i = 0; i < problem.links.size(); ++i) {
    const BundleLink& link = problem.links[i];
    if (link.from >= submap_count || link.to >= submap_count)
      return bad("links", i,
                 fmt::format(" joins submaps {} and {}, but there are {}", link.from, link.to,
                             submap_count));
    if (link.from == link.to)
      return bad("links", i, fmt::format(" joins submap {} with itself", link.from));
    if (const auto message = problem_with(link.from_from_to))
      return bad("links", i, ".from_from_to" + *message);
    if (const auto message = problem_with(link.information))
      return bad("links", i, ".information" + *message);
  }
  return Done{};
}

Status validate_options(const BundleOptions& options) {
  for (const int count : {options.robust_iterations, options.iterations})
    if (count < 0 || count > kMostIterations)
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("iterations of a bundle adjustment: {}, allowed is 0 to 1000", count)};
  if (!within(options.least_progress, 0, 1))
    return Error{ErrorCode::kInvalidArgument,
                 "least_progress of a bundle adjustment is outside [0, 1]"};
  return Done{};
}

// A union-find over submaps: the lowest index is the root, and paths are halved.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t submap) {
  while (parent[submap] != submap) submap = parent[submap] = parent[parent[submap]];
  return submap;
}
void join(std::vector<std::size_t>& parent, std::size_t a, std::size_t b) {
  const std::size_t root_a = root_of(parent, a), root_b = root_of(parent, b);
  parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
}

}  // namespace

Status validate(const BundleProblem& problem, const BundleOptions& options) {
  if (const Status status = validate_options(options); !status.ok()) return status;
  if (const Status status = validate_lists(problem); !status.ok()) return status;
  if (!problem.observations.empty())
    if (const Status status = validate(problem.camera); !status.ok()) return status;
  if (const Status status = validate_observations(problem); !status.ok()) return status;
  return validate_links(problem);
}

std::vector<bool> tied_to_fixed(const BundleProblem& problem,
                                const std::vector<bool>& observation_is_used) {
  const std::size_t submap_count = problem.world_from_submap.size();
  std::vector<std::size_t> parent(submap_count);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (const BundleLink& link : problem.links) join(parent, link.from, link.to);
  std::vector<std::size_t> first_seen_by(problem.landmarks_in_world.size(), submap_count);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    if (!observation_is_used[i]) continue;
    const std::size_t submap = problem.keyframes[problem.observations[i].keyframe].submap;
    std::size_t& first = first_seen_by[problem.observations[i].landmark];
    if (first == submap_count)
      first = submap;
    else
      join(parent, first, submap);
  }
  std::vector<bool> root_is_tied(submap_count, false), tied(submap_count, false);
  for (std::size_t i = 0; i < submap_count; ++i)
    if (problem.is_fixed[i]) root_is_tied[root_of(parent, i)] = true;
  for (std::size_t i = 0; i < submap_count; ++i) tied[i] = root_is_tied[root_of(parent, i)];
  return tied;
}

}  // namespace hermite::adjust
