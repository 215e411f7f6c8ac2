// Bundle adjustment of rigid submaps. The unknowns are the poses of the submaps and the landmarks in the world; a keyframe stands still in
// its submap, where dense tracking put it. One solver serves three ends:
//   local    few submaps free, their neighbours fixed
//   loops    links only, no landmarks: a pose graph
//   global   everything
// (paper section 2; notes section 5.2: the reference's 3D residuals and those here are equal to first order.)
//
// Pure functions of their values: the same problem gives the same solution, bit for bit. Any thread.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

struct BundleKeyframe {
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;  // fixed
  // Of each of its observations' residuals, in (0, 1]: below 1 where they are off together, since the keyframe is not quite where
  // `submap_from_camera` says, and so tell less than as many independent ones. Which are inliers does not depend on it.
  double weight = 1;
};

struct BundleObservation {
  std::uint32_t keyframe = 0;
  std::uint32_t landmark = 0;
  Eigen::Vector2d pixel_px = Eigen::Vector2d::Zero();  // in the undistorted image; may lie outside it
  double depth_m = 0;                                  // 0: none
  double scale = 1;                                    // standard deviation of the keypoint [px]: 1.2^octave
};

// A relative pose that dense tracking or a verified loop measured. Residual: log(inverse(from_from_to) * inverse(world_from_from) *
// world_from_to), in the order of log_se3: metres first, then radians.
// A robust link is believed as far as the others' information allows: of rings with one loop all closed with honest deviations, 7 to 9 of
// 10 where the trackers' were claimed half as large as they were, at most 3 of 10 at a quarter. Better too little information than too
// much.
struct BundleLink {
  std::uint32_t from = 0, to = 0;               // submaps, not the same
  Rigid3 from_from_to;                          // measured
  Matrix6d information = Matrix6d::Identity();  // inverse covariance of that residual; symmetric, positive semi-definite
  bool robust = false;                          // may be wrong, as loops are: Cauchy's loss, so that it then bends little
};

struct BundleProblem {
  Camera camera;  // of all keyframes; read only where there are observations
  std::vector<Rigid3> world_from_submap;
  std::vector<bool> is_fixed;  // one a submap
  std::vector<BundleKeyframe> keyframes;
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
  std::vector<BundleObservation> observations;
  std::vector<BundleLink> links;
};

struct BundleOptions {
  // With Cauchy's loss, before the outliers are dropped. The reference takes 5 and 10 for local adjustment (notes section 5.2).
  int robust_iterations = 5;
  // After that, without a loss. A pose graph has no outliers to drop and takes both counts in one go.
  int iterations = 10;
  // Done when a step lowers the cost by less than this part of it: up to a million observations that is less than what the noise of one
  // makes up.
  double least_progress = 1e-6;
};

struct BundleSolution {
  std::vector<Rigid3> world_from_submap;            // fixed ones bit-identical to the problem's
  std::vector<Eigen::Vector3d> landmarks_in_world;  // metres
  // In front of the camera and its chi-square at the solution at most kPixelAndDepthChi2, or kPixelChi2 without depth (bundle_noise.h).
  std::vector<bool> observation_is_inlier;
  std::vector<double> link_chi2;  // 6 degrees of freedom, see kPoseChi2; without the loss
  // Half the sum of squared whitened residuals, after Cauchy's loss of observations and robust links, over all observations and links:
  // what the problem and the solution can be compared by.
  double initial_cost = 0, final_cost = 0;
  int iteration_count = 0;  // of both stages, steps that were refused too
  bool converged = false;   // the last stage ended by least_progress, not by its count
};

// Levenberg-Marquardt in two stages: robust, then without the observations beyond their chi-square bound and without a loss for the rest.
// The reference's robust loss is Huber's. It bounds the pull of an outlier in the outlier's own deviations, and a wrong near depth with its
// millimetre outweighs many right ones at 2 m: with 20 % of such outliers a fifth of the right observations were lost, with 30 % the poses.
// Cauchy's loss loses 2 to 5 % of them up to 50 % outliers (8 synthetic worlds, starts 2 to 20 cm off; the bound alone takes up to 5 %).
// In turn it wants a start from which most observations of a landmark agree: close a wide loop by its link first, then the landmarks.
// An observation whose landmark is behind its camera, or nearer than kNearest_m, is left out of a stage.
// A landmark that a stage's observations do not hold (fewer than two, or none with depth and all from one keyframe) is not solved for: it
// moves rigidly with the submap of its first observation, and stays where it is when it has none. Submaps that the inliers no longer tie
// to a fixed one stay where the robust stage put them.
//
// kInvalidArgument, naming the field: an index out of range, a number that is not finite or beyond its bound, a pose that is no rotation,
// an information that is not symmetric positive semi-definite, or a submap that neither links nor landmarks tie to a fixed one.
// kBusy when `stop` asked to give up; seen once an iteration.
Result<BundleSolution> adjust(const BundleProblem& problem, const BundleOptions& options, std::stop_token stop = {});

}  // namespace hermite
