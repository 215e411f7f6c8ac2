// Where the camera of a sequence with ground truth was: for disturbances that put things into its scene or look at it from elsewhere.
// `who` begins every error.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/base/image.h"
#include "core/dataset/sequence.h"

namespace hermite {

// What stands in front of the camera is placed by its middle frame, number frame_count / 2.
struct Stage {
  Rigid3 world_from_camera;           // of the middle frame
  double middle_s = 0;                // its time stamp
  Eigen::Vector3d up, forward, side;  // unit, in the world: up is the world's axis, with its sign, that is nearest to the mean of the
                                      // camera's up; forward is where the middle frame looks, brought to the horizontal; side is left
};

// kInvalidArgument: there is no ground truth or no frame.
Result<Stage> stage_of(const Sequence& sequence, const std::string& who);

// Where the camera looks, brought to the horizontal, of unit length. One that looks straight down has its upper edge in front.
Eigen::Vector3d forward_of(const Rigid3& world_from_camera, const Eigen::Vector3d& up);

// world_from_camera of the ground truth at a time, between its poses; before the first and behind the last it stands still. kNotFound:
// there is no pose within 0.1 s.
Result<Rigid3> true_pose(const Sequence& sequence, double time_s, const std::string& who);

// kUnsupported: a camera of its own takes the colour.
Status check_registered(const Sequence& sequence, const std::string& who);

// What an image has at pixel (x, y) comes from there, at a depth of 1 in the camera; of the lens, if there is one.
Eigen::Vector3d ray_of(const Camera& camera, int x, int y);

// ray_of of every pixel.
Image<Eigen::Vector3d> rays_of(const Camera& camera);

// Where a point in front of the camera is in its image, the lens included [px].
Eigen::Vector2d pixel_of(const Camera& camera, const Eigen::Vector3d& point_in_camera);

}  // namespace hermite
