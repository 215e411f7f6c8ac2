// One run of the solver: which observations take part and who is held is decided before. The part of bundle adjustment that is Ceres.
#pragma once

#include <stop_token>
#include <vector>

#include "core/adjust/bundle.h"

namespace hermite {

struct BundleState {
  std::vector<Rigid3> world_from_submap;
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
};

struct BundleStage {
  std::vector<bool> submap_is_held{};
  std::vector<bool> observation_is_used{};  // those of landmarks that are solved for
  bool robust = false;                      // Cauchy's loss on observations; robust links have it anyhow
  int iterations = 0;                       // at most
  double least_progress = 0;
};

struct StageOutcome {
  int iteration_count = 0;
  bool converged = false;  // true too when there was nothing to solve
  bool stopped = false;    // `stop` asked; the state is that of the last good step then
};

// Moves `state` to a minimum of the used observations and all links. Landmarks without a used observation and held submaps keep their bits.
// Where no step succeeds, nothing moves. The problem must be valid.
StageOutcome solve_stage(const BundleProblem& problem, const BundleStage& stage, std::stop_token stop, BundleState& state);

// Half of Cauchy's loss of a chi-square whose right values end at `bound`, as the solver has it.
double cauchy_cost(double chi2, double bound);

}  // namespace hermite
