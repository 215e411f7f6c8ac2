// The pose of a camera from points that it measured and points of the map, some of the pairs being wrong.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

struct PointPair {
  Eigen::Vector3d point_in_camera_m = Eigen::Vector3d::Zero();  // measured: pixel and depth
  Eigen::Vector3d point_in_world_m = Eigen::Vector3d::Zero();   // of the map
  double pixel_sigma_px = 1;                                    // of the measured pixel
  double world_sigma_m = 0;                                     // of the map's point, in every direction
};

struct RansacOptions {
  std::size_t least_inliers = 15;
  std::uint32_t seed = 1;
};

struct RigidMatch {
  Rigid3 world_from_camera;
  std::vector<std::uint32_t> inliers;  // indices of pairs, ascending
};

// Samples of three pairs (Umeyama without scale), until another one better than the best has a chance below 1 in 1000 or kMaxDraws are
// drawn; then least squares over the inliers, repeated until they stay. An inlier agrees within three standard deviations both in the image
// and in depth: depth noise grows with its square (bundle_noise.h), so a distance in space would let in too much near and too little far.
// Pairs that are not finite or not in front of the camera are left out. Nothing when fewer than `least_inliers` agree. Deterministic in the
// pairs' order and the seed.
inline constexpr int kMaxDraws = 10'000;
std::optional<RigidMatch> match_rigidly(const std::vector<PointPair>& pairs, const Camera& camera, const RansacOptions& options = {});

// The same from a guess of the pose that has most of its inliers already, without sampling.
std::optional<RigidMatch> refine_rigidly(const std::vector<PointPair>& pairs, const Camera& camera, const Rigid3& world_from_camera_guess,
                                         std::size_t least_inliers);

}  // namespace hermite
