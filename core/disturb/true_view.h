// The true poses of a sequence's camera, for disturbances that add objects to its scene or render
// it from other poses. Every error begins with `who`.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/base/image.h"
#include "core/dataset/sequence.h"

namespace hermite::disturb {

// Objects in front of the camera are placed relative to its middle frame, number frame_count / 2.
struct Stage {
  Rigid3 world_from_camera;  // of the middle frame
  double middle_s = 0;       // time stamp of the middle frame
  // Unit, in the world: up is the world's axis, with its sign, that is nearest to the mean of the
  // camera's up; forward is where the middle frame looks, brought to the horizontal; side is left.
  Eigen::Vector3d up, forward, side;
};

// Returns kInvalidArgument when there is no ground truth or no frame.
Result<Stage> stage_of(const dataset::Sequence& sequence, const std::string& who);

// Returns the viewing direction, projected to the horizontal, as a unit vector. For a camera that
// looks straight down it is the direction of the upper image edge.
Eigen::Vector3d forward_of(const Rigid3& world_from_camera, const Eigen::Vector3d& up);

// Returns world_from_camera of the ground truth at a time, interpolated between its poses; before
// the first and after the last one, at the velocity beside them. kNotFound when there is no pose
// within 0.1 s.
Result<Rigid3> true_pose(const dataset::Sequence& sequence, double time_s, const std::string& who);

// Returns kUnsupported when there is a separate colour camera.
Status check_registered(const dataset::Sequence& sequence, const std::string& who);

// Returns the ray through pixel (x, y), with depth 1 in the camera frame, including the distortion
// if there is any.
Eigen::Vector3d ray_of(const Camera& camera, int x, int y);

// Returns ray_of() for every pixel.
Image<Eigen::Vector3d> rays_of(const Camera& camera);

// Returns the pixel at which a point in front of the camera appears, including the distortion [px].
Eigen::Vector2d pixel_of(const Camera& camera, const Eigen::Vector3d& point_in_camera);

}  // namespace hermite::disturb
