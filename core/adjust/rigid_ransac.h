// The pose of a camera from pairs of measured points and map points, some of which are wrong
// (RANSAC).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::adjust {

struct PointPair {
  Eigen::Vector3d point_in_camera_m = Eigen::Vector3d::Zero();  // measured by pixel and depth
  Eigen::Vector3d point_in_world_m = Eigen::Vector3d::Zero();   // position in the map
  double pixel_sigma_px = 1;                                    // of the measured pixel
  double world_sigma_m = 0;                                     // of the map point, isotropic
};

struct RansacOptions {
  std::size_t least_inliers = 15;
  std::uint32_t seed = 1;
};

struct RigidMatch {
  Rigid3 world_from_camera;
  std::vector<std::uint32_t> inliers;  // indices of pairs, ascending
};

// Most samples of three pairs that are drawn.
inline constexpr int kMaxDraws = 10'000;

// Samples three pairs (Umeyama without scale) until the probability of missing a better pose is
// below 1 in 1000 or kMaxDraws samples are drawn; then repeats least squares over the inliers until
// these no longer change. An inlier agrees within three standard deviations both in the image and
// in depth: depth noise grows with the square of depth (bundle_noise.h), so a threshold on the 3D
// distance would accept too much near and too little far away. Pairs that are not finite or not in
// front of the camera are skipped. Returns nullopt if fewer than `least_inliers` agree.
// Deterministic in the order of pairs and the seed.
std::optional<RigidMatch> match_rigidly(const std::vector<PointPair>& pairs, const Camera& camera,
                                        const RansacOptions& options = {});

// The same without sampling, from a guess of the pose that already has most of its inliers.
std::optional<RigidMatch> refine_rigidly(const std::vector<PointPair>& pairs, const Camera& camera,
                                         const Rigid3& world_from_camera_guess,
                                         std::size_t least_inliers);

}  // namespace hermite::adjust
