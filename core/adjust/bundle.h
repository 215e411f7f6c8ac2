// Bundle adjustment of rigid submaps. The unknowns are the submap poses and the landmark positions
// in the world; a keyframe keeps the pose in its submap that dense tracking gave it. One solver
// serves three purposes:
//   local    few submaps are free, their neighbours are fixed
//   loops    only links and no landmarks: a pose graph
//   global   everything
// (Paper, section 2. The 3D residuals of the authors' program equal those here to first order.)
//
// Pure functions: the same problem gives the same solution, bit for bit. Thread-safe.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::adjust {

struct BundleKeyframe {
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;  // fixed
  // Weight of the residuals of all its observations, in (0, 1]. It is below 1 where they share an
  // error, because `submap_from_camera` is not exact, and therefore carry less information than
  // independent ones. It does not affect which observations are inliers.
  double weight = 1;
};

struct BundleObservation {
  std::uint32_t keyframe = 0;
  std::uint32_t landmark = 0;
  // In the undistorted image; may lie outside it.
  Eigen::Vector2d pixel_px = Eigen::Vector2d::Zero();
  double depth_m = 0;  // 0: no depth
  // Standard deviation of the keypoint [px]: 1.2^octave.
  double scale = 1;
};

// A relative pose measured by dense tracking or by a verified loop. The residual is
// log(inverse(from_from_to) * inverse(world_from_from) * world_from_to), in the order of log_se3:
// metres first, then radians.
// A robust link wins or loses against the information of the other links. In rings with one loop
// and honest deviations, every loop closed; where the trackers' deviations were claimed half as
// large as they were, 7 to 9 of 10 did, and at a quarter at most 3 of 10. It is better to claim too
// little information than too much.
struct BundleLink {
  std::uint32_t from = 0, to = 0;  // submap indices, never equal
  Rigid3 from_from_to;             // measured
  // Inverse covariance of that residual; symmetric, positive semi-definite.
  Matrix6d information = Matrix6d::Identity();
  // An uncertain link, such as a loop: Cauchy's loss keeps a wrong one from bending the map much.
  bool robust = false;
};

struct BundleProblem {
  Camera camera;  // shared by all keyframes; only read if there are observations
  std::vector<Rigid3> world_from_submap;
  std::vector<bool> is_fixed;  // one per submap
  std::vector<BundleKeyframe> keyframes;
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
  std::vector<BundleObservation> observations;
  std::vector<BundleLink> links;
};

struct BundleOptions {
  // Iterations with Cauchy's loss, before outliers are dropped. The authors' program takes 5 and 10
  // for local adjustment.
  int robust_iterations = 5;
  // Iterations after that, without a loss. A pose graph has no outliers to drop and uses both
  // counts in one stage.
  int iterations = 10;
  // The solver has converged when a step lowers the cost by less than this fraction. Up to a
  // million observations, that is less than the noise of a single one contributes.
  double least_progress = 1e-6;
};

struct BundleSolution {
  // Fixed submaps are bit-identical to the problem's.
  std::vector<Rigid3> world_from_submap;
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
  // True if the landmark is in front of the camera and the chi-square at the solution is at most
  // kPixelAndDepthChi2, or kPixelChi2 without depth (bundle_noise.h).
  std::vector<bool> observation_is_inlier;
  // Chi-squares of the links, with 6 degrees of freedom and without the loss; compare with
  // kPoseChi2.
  std::vector<double> link_chi2;
  // Half the sum of squared whitened residuals over all observations and links, with Cauchy's loss
  // on observations and robust links. The two values compare the problem with its solution.
  double initial_cost = 0, final_cost = 0;
  int iteration_count = 0;  // over both stages, including rejected steps
  bool converged = false;   // the last stage ended by least_progress, not by its iteration limit
};

// Solves the problem by Levenberg-Marquardt in two stages: the first is robust, the second drops
// observations beyond their chi-square bound and uses no loss for the rest.
// The robust loss of the authors' program is Huber's. It bounds the pull of an outlier in units of
// the outlier's own deviation, so a wrong near depth with its deviation of a millimetre outweighs
// many correct ones at 2 m: with 20 % of such outliers a fifth of the correct observations were
// lost, with 30 % the poses. Cauchy's loss loses 2 to 5 % of the correct observations with up to 50
// % outliers (8 synthetic worlds, starts 2 to 20 cm off; the bound alone rejects up to 5 %). In
// turn it needs a start at which most observations of a landmark agree: close a wide loop by its
// link first, then add the landmarks.
// A stage leaves out observations whose landmark is behind its camera or nearer than kNearest_m. It
// does not solve for a landmark that its observations do not determine (fewer than two, or none
// with depth and all from one keyframe); such a landmark moves rigidly with the submap of its first
// observation, or stays when it has none. Submaps that the inliers no longer connect to a fixed one
// stay where the robust stage put them.
//
// Returns kInvalidArgument naming the field when an index is out of range, a number is not finite
// or beyond its bound, a pose is not a rotation, an information matrix is not symmetric positive
// semi-definite, or a submap is connected to a fixed one by neither links nor landmarks. Returns
// kBusy when `stop` was requested, which is checked once per iteration.
Result<BundleSolution> adjust(const BundleProblem& problem, const BundleOptions& options,
                              std::stop_token stop = {});

}  // namespace hermite::adjust
