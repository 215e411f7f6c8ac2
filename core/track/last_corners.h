// The corners of the last tracked frame, which are followed to the next one: as tracks over many
// frames, which tell what moves on its own, and as points with depth, which tell how the camera has
// moved.
//
// Runs on the host. One thread at a time.
#pragma once

#include <functional>
#include <optional>

#include "core/track/corner_points.h"
#include "core/track/corner_tracks.h"

namespace hermite::track {

class LastCorners {
 public:
  // `camera` is that of rectified frames. For `keeps_moving` see CornerTracks.
  LastCorners(const Camera& camera, const frame::FrameOptions& options, bool keeps_moving)
      : tracks_(camera, keeps_moving), points_(camera, options) {}

  // See CornerTracks::follow(). The result is kept only if remember_tracks() follows.
  CornerVerdict follow_tracks(const frame::ImageFeatures& frame) {
    return tracks_.follow(features_, frame);
  }

  // Returns the camera's motion since the last frame; see CornerPoints::follow().
  std::optional<FeatureMotion> follow_points(
      const frame::ImageFeatures& frame,
      const std::function<bool(const Eigen::Vector2d&)>& is_left_out) {
    return points_.follow(features_, frame, is_left_out);
  }

  // Makes the frame that was followed the last one; see CornerTracks::remember().
  void remember_tracks(const frame::ImageFeatures& frame,
                       const std::function<float(int, int)>& depth_m,
                       const std::function<bool(int, int)>& is_moving) {
    tracks_.remember(frame, depth_m, is_moving);
    features_ = frame;
  }

  // Call it after remember_tracks(), unless the frame has no pose; see CornerPoints::remember().
  void remember_points(const frame::ImageFeatures& frame, const DepthImage& depth,
                       const Rigid3& last_from_camera,
                       const std::function<bool(const Eigen::Vector2d&)>& moves) {
    points_.remember(frame, depth, last_from_camera, moves);
  }

  // Makes a frame the last one whose points alone are followed, since it is not to be in the map.
  void remember_start(const frame::ImageFeatures& frame, const DepthImage& depth) {
    points_.remember(frame, depth, Rigid3{}, [](const Eigen::Vector2d&) { return false; });
    features_ = frame;
  }

  // For when the next frame may be seen from elsewhere.
  void forget_points() { points_.forget(); }

  void save(ByteWriter& bytes) const {
    frame::save(bytes, features_);
    tracks_.save(bytes);
    points_.save(bytes);
  }
  void restore(ByteReader& bytes) {
    frame::restore(bytes, features_);
    tracks_.restore(bytes);
    points_.restore(bytes, features_);
  }

 private:
  frame::ImageFeatures features_;
  CornerTracks tracks_;
  CornerPoints points_;
};

}  // namespace hermite::track
