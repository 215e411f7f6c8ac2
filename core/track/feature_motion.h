// The camera's motion between two pictures from corners that are followed through them: where tracking starts. It finds its way over tens
// of pixels and where hardly any depth is measured; of what moves in the view it knows nothing.
//
// Pure functions, host only, any thread.
#pragma once

#include <optional>
#include <vector>

#include "core/frame/picture_features.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/normal_equations.h"

namespace hermite {

// Where a corner of `earlier` is in `frame`, in pixels of levels[0]: Lucas and Kanade, from coarse to fine. Nothing: it has left the image,
// looks otherwise, or does not lead back to where it came from.
std::optional<Eigen::Vector2d> follow(const PictureFeatures& earlier, const PictureFeatures& frame, const Eigen::Vector2d& corner_px);

// What a corner looks like: the pixels around it, which is the one in the middle. Empty where the image ends too near to it.
GreyImage patch_around(const GreyImage& image, const Corner& corner);
int patch_side_px();

// Where `image` looks like the patch, within a pixel of `near_px`. Nothing: nowhere.
std::optional<Eigen::Vector2d> find_patch(const GreyImage& patch, const GreyImage& image, const Eigen::Vector2d& near_px);

// A corner that was followed: a point in the earlier camera's frame, and where the frame shows it.
struct FollowedCorner {
  Eigen::Vector3d point_in_earlier;  // metres; at depth 1 where the depth is unknown
  Eigen::Vector2d pixel;
};

struct FeatureMotion {
  Rigid3 earlier_from_frame;
  bool is_turn_only = false;  // too few corners have a depth: the translation is not known
  int corner_count = 0;       // that agree
  double deviation_px = 0;    // of the image
  Camera camera;
  std::vector<FollowedCorner> corners;  // all whose depth is known
};

// How many corners, and which share of them, are within two pixels of where this motion puts them.
struct CornerAgreement {
  int count = 0;
  double share = 0;
};
CornerAgreement corners_at(const FeatureMotion& features, const Rigid3& earlier_from_frame);

// The system of a step of earlier_from_frame <- exp(x) earlier_from_frame, in information: one over metres and radians squared.
NormalEquations feature_terms(const FeatureMotion& features, const Rigid3& earlier_from_frame);

// Of corners that were followed, those whose depth is known twice, out of `corner_count`. `camera` is that of straight frames. Nothing: too
// few agree with any motion.
std::optional<FeatureMotion> motion_by_corners(const std::vector<FollowedCorner>& all, const std::vector<FollowedCorner>& with_depth,
                                               std::size_t corner_count, const Camera& camera);

}  // namespace hermite
