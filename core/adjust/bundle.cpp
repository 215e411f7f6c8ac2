#include "core/adjust/bundle.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/adjust/bundle_check.h"
#include "core/adjust/bundle_noise.h"
#include "core/adjust/bundle_residuals.h"
#include "core/adjust/bundle_stage.h"

namespace hermite::adjust {

namespace {

// The cost and the inliers of the problem at a given state.
struct Appraisal {
  double cost = 0;
  std::vector<bool> is_in_front;
  std::vector<bool> is_inlier;  // implies is_in_front
  std::vector<double> link_chi2;
};

Appraisal appraise(const BundleProblem& problem, const BundleState& state) {
  Appraisal appraisal;
  const std::vector<KeyframeView> views = views_of(problem);
  for (const BundleObservation& observation : problem.observations) {
    const Rigid3& world_from_submap =
        state.world_from_submap[problem.keyframes[observation.keyframe].submap];
    const ObservationResidual residual =
        observation_residual(observation, views[observation.keyframe], world_from_submap,
                             state.landmarks_in_world[observation.landmark], nullptr);
    const double chi2 = residual.whitened.squaredNorm(), bound = chi2_bound(observation);
    appraisal.cost += problem.keyframes[observation.keyframe].weight * cauchy_cost(chi2, bound);
    appraisal.is_in_front.push_back(residual.landmark_depth_m > kNearest_m);
    appraisal.is_inlier.push_back(residual.landmark_depth_m > kNearest_m && chi2 <= bound);
  }
  for (const BundleLink& link : problem.links) {
    const Vector6d residual = link_residual(link.from_from_to, state.world_from_submap[link.from],
                                            state.world_from_submap[link.to], nullptr);
    const double chi2 = std::max(0.0, residual.dot(link.information * residual));
    appraisal.cost += link.robust ? cauchy_cost(chi2, kPoseChi2) : 0.5 * chi2;
    appraisal.link_chi2.push_back(chi2);
  }
  return appraisal;
}

// Selects from `usable` the observations of landmarks that they determine: two or more
// observations, with a depth or from two keyframes.
std::vector<bool> observations_of_determined_landmarks(const BundleProblem& problem,
                                                       const std::vector<bool>& usable) {
  struct Support {
    int count = 0;
    std::uint32_t first_keyframe = 0;
    bool has_depth = false, has_two_keyframes = false;
  };
  std::vector<Support> supports(problem.landmarks_in_world.size());
  for (std::size_t i = 0; i < usable.size(); ++i) {
    if (!usable[i]) continue;
    const BundleObservation& observation = problem.observations[i];
    Support& support = supports[observation.landmark];
    if (support.count == 0) support.first_keyframe = observation.keyframe;
    support.count += 1;
    support.has_depth |= observation.depth_m > 0;
    support.has_two_keyframes |= observation.keyframe != support.first_keyframe;
  }
  std::vector<bool> used(usable.size());
  for (std::size_t i = 0; i < usable.size(); ++i) {
    const Support& support = supports[problem.observations[i].landmark];
    used[i] = usable[i] && support.count >= 2 && (support.has_depth || support.has_two_keyframes);
  }
  return used;
}

// Moves landmarks that were not solved for rigidly with the submap of their first observation, from
// `before` to `state`.
void carry_landmarks(const BundleProblem& problem, const std::vector<bool>& used,
                     const BundleState& before, BundleState& state) {
  std::vector<bool> is_done(problem.landmarks_in_world.size(), false);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) is_done[problem.observations[i].landmark] = true;
  for (const BundleObservation& observation : problem.observations) {
    if (is_done[observation.landmark]) continue;
    is_done[observation.landmark] = true;
    const std::uint32_t submap = problem.keyframes[observation.keyframe].submap;
    const Rigid3 &was = before.world_from_submap[submap], &is = state.world_from_submap[submap];
    // Keep every bit.
    if (was.rotation.coeffs() == is.rotation.coeffs() && was.translation == is.translation)
      continue;
    state.landmarks_in_world[observation.landmark] =
        is * (inverse(was) * before.landmarks_in_world[observation.landmark]);
  }
}

// Runs one stage, as `stage` says, with those of the usable observations whose landmarks they
// determine. Submaps that these no longer connect to a fixed one are held.
StageOutcome run_stage(const BundleProblem& problem, const std::vector<bool>& usable,
                       BundleStage stage, std::stop_token stop, BundleState& state) {
  stage.observation_is_used = observations_of_determined_landmarks(problem, usable);
  stage.submap_is_held = tied_to_fixed(problem, stage.observation_is_used);
  for (std::size_t i = 0; i < problem.is_fixed.size(); ++i)
    stage.submap_is_held[i] = problem.is_fixed[i] || !stage.submap_is_held[i];
  const BundleState before = state;
  const StageOutcome outcome = solve_stage(problem, stage, std::move(stop), state);
  carry_landmarks(problem, stage.observation_is_used, before, state);
  return outcome;
}

Status validate_ties(const BundleProblem& problem) {
  const std::vector<bool> tied =
      tied_to_fixed(problem, std::vector<bool>(problem.observations.size(), true));
  const auto loose = std::find(tied.begin(), tied.end(), false);
  if (loose == tied.end()) return Done{};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("world_from_submap[{}] is connected to no fixed submap, neither by "
                           "links nor by landmarks",
                           loose - tied.begin())};
}

}  // namespace

Result<BundleSolution> adjust(const BundleProblem& problem, const BundleOptions& options,
                              std::stop_token stop) {
  if (const Status status = validate(problem, options); !status.ok()) return status.error();
  if (const Status status = validate_ties(problem); !status.ok()) return status.error();
  const Error given_up{ErrorCode::kBusy, "the bundle adjustment was cancelled"};

  BundleSolution solution;
  BundleState state{problem.world_from_submap, problem.landmarks_in_world};
  const Appraisal start = appraise(problem, state);
  const bool only_links = problem.observations.empty();
  BundleStage robust{.robust = true,
                     .iterations = options.robust_iterations,
                     .least_progress = options.least_progress};
  if (only_links) robust.iterations += options.iterations;
  StageOutcome outcome = run_stage(problem, start.is_in_front, robust, stop, state);
  solution.iteration_count = outcome.iteration_count;
  if (outcome.stopped) return given_up;
  if (!only_links) {
    const BundleStage plain{.robust = false,
                            .iterations = options.iterations,
                            .least_progress = options.least_progress};
    outcome = run_stage(problem, appraise(problem, state).is_inlier, plain, stop, state);
    solution.iteration_count += outcome.iteration_count;
    if (outcome.stopped) return given_up;
  }

  Appraisal end = appraise(problem, state);
  solution.world_from_submap = std::move(state.world_from_submap);
  solution.landmarks_in_world = std::move(state.landmarks_in_world);
  solution.observation_is_inlier = std::move(end.is_inlier);
  solution.link_chi2 = std::move(end.link_chi2);
  solution.initial_cost = start.cost;
  solution.final_cost = end.cost;
  solution.converged = outcome.converged;
  return solution;
}

}  // namespace hermite::adjust
