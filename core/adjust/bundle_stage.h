// One run of the Ceres solver. Which observations take part and which submaps are held has been
// decided before.
#pragma once

#include <stop_token>
#include <vector>

#include "core/adjust/bundle.h"

namespace hermite::adjust {

struct BundleState {
  std::vector<Rigid3> world_from_submap;
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
};

struct BundleStage {
  std::vector<bool> submap_is_held{};
  std::vector<bool> observation_is_used{};  // only of landmarks that are solved for
  // Cauchy's loss on observations; robust links always have it.
  bool robust = false;
  int iterations = 0;  // upper limit
  double least_progress = 0;
};

struct StageOutcome {
  int iteration_count = 0;
  bool converged = false;  // also true when there was nothing to solve
  bool stopped = false;    // `stop` was requested; the state is that of the last successful step
};

// Moves `state` to a minimum over the used observations and all links. Landmarks without a used
// observation and held submaps keep their bits. If no step succeeds, nothing moves. The problem
// must be valid.
StageOutcome solve_stage(const BundleProblem& problem, const BundleStage& stage,
                         std::stop_token stop, BundleState& state);

// Returns half of Cauchy's loss of a chi-square, with scale `bound`, as the solver computes it.
double cauchy_cost(double chi2, double bound);

}  // namespace hermite::adjust
