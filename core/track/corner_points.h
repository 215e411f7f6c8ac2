// Corners of the picture that are followed through many frames, as points of the room. Each stays where it was first seen, so that a camera
// that is held by them does not drift as long as they are in view, as it would from frame to frame. Depth comes from the frames, as often
// as they have it, and where none does from two directions that a corner was seen in.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/frame_options.h"
#include "core/frame/picture_features.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"

namespace hermite {

// All in the camera's frame of the frame remembered last, and in pixels of its levels[0].
struct CornerPoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // at depth 1 where the depth is unknown
  double depth_deviation_m = 0;                       // 0: the depth is unknown
  // Where it was seen from at first, and while its depth is unknown, how far from there two directions said that it is, and by which share
  // of that they may be wrong; 0: they have not yet.
  Eigen::Vector3d first_place_m = Eigen::Vector3d::Zero(), first_direction = Eigen::Vector3d::UnitZ();
  double crossed_at = 0, crossed_share = 0;
  GreyImage patch;  // and what it looked like then
};

class CornerPoints {
 public:
  // `camera` is that of straight frames.
  CornerPoints(const Camera& camera, const FrameOptions& options) : camera_(camera), options_(options) {}

  // The camera's motion since `last`, which is the frame remembered last. `is_left_out` tells by pixel of levels[0] of this frame what is
  // not to be followed, to several threads at once. Nothing: too few corners agree with any motion.
  std::optional<FeatureMotion> follow(const PictureFeatures& last, const PictureFeatures& frame,
                                      const std::function<bool(const Eigen::Vector2d&)>& is_left_out);

  // The frame that was followed last is tracked: where it is beside the one remembered before, and its depth. `moves` tells by pixel of
  // levels[0] what is not to be followed.
  void remember(const PictureFeatures& frame, const DepthImage& depth, const Rigid3& last_from_camera,
                const std::function<bool(const Eigen::Vector2d&)>& moves);

  // The next frame is elsewhere.
  void forget();

  const std::vector<CornerPoint>& all() const { return points_; }

  void save(ByteWriter& bytes) const;
  // Of a frame that has these features.
  void restore(ByteReader& bytes, const PictureFeatures& last);

 private:
  bool carry(CornerPoint& point, const Eigen::Vector2d& pixel, const DepthImage& depth, const Rigid3& camera_from_last) const;
  void measure(CornerPoint& point, double depth_m) const;
  void triangulate(CornerPoint& point) const;
  CornerPoint seen_first(const Corner& corner, const GreyImage& image) const;
  Eigen::Vector2d image_px(const Eigen::Vector2d& level_px) const;

  const Camera camera_;
  const FrameOptions options_;
  int image_px_ = 1;  // PictureFeatures::image_px
  std::vector<CornerPoint> points_;
  std::vector<std::optional<Eigen::Vector2d>> found_;  // by point, in the frame that was followed last
};

}  // namespace hermite
