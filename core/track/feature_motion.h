// Estimates the camera's motion between two images from followed corners, as the starting point of
// tracking. It copes with displacements of tens of pixels and with hardly any depth; it does not
// detect moving objects.
//
// Pure functions on the host. Any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/frame/image_features.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/normal_equations.h"

namespace hermite::track {

// Returns the position in `frame` of a corner of `earlier`, in pixels of levels[0], by pyramidal
// Lucas-Kanade tracking; std::nullopt if it has left the image, looks different, or does not lead
// back to where it came from.
std::optional<Eigen::Vector2d> follow(const frame::ImageFeatures& earlier,
                                      const frame::ImageFeatures& frame,
                                      const Eigen::Vector2d& corner_px);

// Returns the pixels around a corner, which is in the middle; empty if it is too near to the image
// border.
frame::GreyImage patch_around(const frame::GreyImage& image, const frame::Corner& corner);
int patch_side_px();

// Returns where the image matches the patch, within a pixel of `near_px`; std::nullopt if it does
// nowhere.
std::optional<Eigen::Vector2d> find_patch(const frame::GreyImage& patch,
                                          const frame::GreyImage& image,
                                          const Eigen::Vector2d& near_px);

// A followed corner: its point in the earlier camera frame, and its position in the later frame.
struct FollowedCorner {
  Eigen::Vector3d point_in_earlier;  // metres; at depth 1 where the depth is unknown
  Eigen::Vector2d pixel;
};

struct FeatureMotion {
  Rigid3 earlier_from_frame;
  bool is_turn_only = false;  // too few corners have a depth, so the translation is unknown
  int corner_count = 0;       // number of corners that agree
  double deviation_px = 0;    // image pixels
  Camera camera;
  std::vector<FollowedCorner> corners;  // all corners whose depth is known
};

// Number and share of the corners whose reprojection error at this motion is at most two pixels.
struct CornerAgreement {
  int count = 0;
  double share = 0;
};
CornerAgreement corners_at(const FeatureMotion& features, const Rigid3& earlier_from_frame);

// Returns whether most of these corners, of a camera that is rectified, contradict the motion: they
// are off by nearly their whole displacement. Rolling shutters and delayed colour images cause up
// to half of it.
bool do_contradict(const std::vector<FollowedCorner>& corners, const Camera& camera,
                   const Rigid3& earlier_from_frame);

// Returns the system of a step of earlier_from_frame <- exp(x) earlier_from_frame, as information
// in 1/m^2 and 1/rad^2.
NormalEquations feature_terms(const FeatureMotion& features, const Rigid3& earlier_from_frame);

// Estimates the motion from the followed corners `all`, of which `with_depth` have a depth, out of
// `corner_count`. `camera` is that of rectified frames. Returns std::nullopt if too few corners
// agree with any motion.
std::optional<FeatureMotion> motion_by_corners(const std::vector<FollowedCorner>& all,
                                               const std::vector<FollowedCorner>& with_depth,
                                               std::size_t corner_count, const Camera& camera);

}  // namespace hermite::track
