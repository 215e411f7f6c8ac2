// Corners of the image that are followed through many frames, as 3D points. The view in which a
// corner was first seen is kept, so a camera that is localised by these corners does not drift
// while they are in view, as it would with motion estimated from frame to frame. The depth of a
// corner is measured again in each frame that has depth there; where no frame has, it is
// triangulated from two viewing directions.
//
// Runs on the host. One thread at a time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/frame_options.h"
#include "core/frame/image_features.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"

namespace hermite::track {

// Positions are in the camera frame of the last remembered frame, pixels are those of its
// levels[0].
struct CornerPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // at depth 1 where the depth is unknown
  double depth_deviation_m = 0;                       // 0: the depth is unknown
  // The position from which the corner was first seen, and its direction from there. While the
  // depth is unknown: distance along that direction at which two viewing directions intersected,
  // and its relative deviation; 0 before they have intersected.
  Eigen::Vector3d first_place_m = Eigen::Vector3d::Zero(),
                  first_direction = Eigen::Vector3d::UnitZ();
  double crossed_at = 0, crossed_share = 0;
  frame::GreyImage patch;  // image patch around the corner when it was first seen
};

class CornerPoints {
 public:
  // `camera` is that of rectified frames.
  CornerPoints(const Camera& camera, const frame::FrameOptions& options)
      : camera_(camera), options_(options) {}

  // Returns the camera's motion since `last`, which is the last remembered frame; std::nullopt if
  // too few corners agree with any motion. `is_left_out` returns for a pixel of levels[0] of this
  // frame whether to ignore it; it is called from several threads at once.
  std::optional<FeatureMotion> follow(
      const frame::ImageFeatures& last, const frame::ImageFeatures& frame,
      const std::function<bool(const Eigen::Vector2d&)>& is_left_out);

  // Makes the frame that was last followed the last remembered one, given its pose relative to the
  // one before and its depth. `moves` returns for a pixel of levels[0] whether corners there are to
  // be dropped.
  void remember(const frame::ImageFeatures& frame, const DepthImage& depth,
                const Rigid3& last_from_camera,
                const std::function<bool(const Eigen::Vector2d&)>& moves);

  // Drops all corners, for when the next frame may be seen from elsewhere.
  void forget();

  const std::vector<CornerPoint>& all() const { return points_; }

  void save(ByteWriter& bytes) const;
  // `last` are the features of the frame that was the last remembered one when saved.
  void restore(ByteReader& bytes, const frame::ImageFeatures& last);

 private:
  bool carry(CornerPoint& point, const Eigen::Vector2d& pixel, const DepthImage& depth,
             const Rigid3& camera_from_last) const;
  void measure(CornerPoint& point, double depth_m) const;
  void triangulate(CornerPoint& point) const;
  CornerPoint seen_first(const frame::Corner& corner, const frame::GreyImage& image) const;
  Eigen::Vector2d image_px(const Eigen::Vector2d& level_px) const;

  const Camera camera_;
  const frame::FrameOptions options_;
  int image_px_ = 1;  // ImageFeatures::image_px
  std::vector<CornerPoint> points_;
  // By point, position in the frame that was last followed.
  std::vector<std::optional<Eigen::Vector2d>> found_;
};

}  // namespace hermite::track
