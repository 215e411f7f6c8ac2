// The part of a scan that runs on the GPU: frames are tracked against the surface that the map predicts, and fused into it.
//
// Every function blocks until the GPU is done, unless it says that it records. One thread at a time: the device's.
#pragma once

#include <optional>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/byte_stream.h"
#include "core/base/timeline.h"
#include "core/frame/frame_content.h"
#include "core/frame/prepared_frame.h"
#include "core/frame/preprocess.h"
#include "core/gpu/device.h"
#include "core/map/fuse.h"
#include "core/map/index_map.h"
#include "core/map/predict.h"
#include "core/map/surfel_store.h"
#include "core/map/visible_blocks.h"
#include "core/pipeline/options.h"
#include "core/track/corner_points.h"
#include "core/track/corner_tracks.h"
#include "core/track/feature_motion.h"
#include "core/track/lens_shading.h"
#include "core/track/map_certainty.h"
#include "core/track/moving_regions.h"
#include "core/track/odometry.h"

namespace hermite {

// What of a frame's picture goes into the map.
struct PictureUse {
  bool is_good = true;
  Brightness brightness;
};

struct Motion {
  OdometryResult odometry;
  Judgement judgement;
};

class FrontEnd {
 public:
  FrontEnd(const std::string& device, const Camera& camera, const Options& options, Timeline* timeline);

  // Records.
  void preprocess(const PreparedFrame& frame, std::int64_t frame_index);

  // The frame preprocessed last, whose picture has these features, against the prediction; reference_from_camera is relative to where that
  // is seen from, which is `world_from_reference`. `lost_count`: frames lost just before this one. What moves in the frame is masked from
  // here on.
  Motion track(const FrameContent& content, const PictureFeatures& features, const DepthImage& depth, const Rigid3& world_from_reference,
               const Rigid3& last_motion, int lost_count);

  // What moves in the frame tracked last, by coarse pixel, and how much of its surface that is.
  const CoarseMask& moving() const { return moving_mask_; }
  const CoarseView& coarse_view() const { return view_; }

  // The frame tracked last is where it is: later ones are compared with it to tell what moves, and its corners are followed. Lost frames,
  // and corrections of the map, leave nothing to compare with; a camera that is found elsewhere, no corners either.
  void remember_view(const Rigid3& world_from_camera, const Rigid3& reference_from_camera, const PreparedFrame& frame);
  void forget_views();
  void forget_corners() { corner_points_.forget(); }

  // How well it is known where the frame tracked last is, on the map as it lies in `layout`. Once for each frame that is not lost.
  PoseUncertainty uncertainty_at(const Rigid3& world_from_camera, const OdometryResult& step, const MapLayout& layout);
  CalibrationDoubt calibration_doubt() const { return certainty_.calibration(); }

  // The camera fits what it has seen, up to these deviations of its bend and its focal length; or it does not, by so much.
  void camera_fits(double bend_deviation, double focal_deviation) { certainty_.camera_fits(bend_deviation, focal_deviation); }
  void camera_is_off(double bend, double focal) { certainty_.camera_is_off(bend, focal); }

  // What follows belongs to a new component of the map.
  void begin_component() { certainty_.begin_component(); }

  // Whether the frame shows enough surface to begin a map, or a component of one.
  Judgement judge_start(const FrameContent& content);

  // Aligns the frame preprocessed last with the surface of the candidate's submaps: nothing where they do not fit. Replaces the prediction.
  std::optional<LoopVerification> verify(const LoopCandidate& candidate, const MapLayout& layout);

  // Records: the frame preprocessed last, seen from `world_from_camera`, is fused into the active submaps, what is new into the current
  // one. No: the map is full, and nothing new was added.
  bool fuse(const Rigid3& world_from_camera, const MapLayout& layout, const PictureUse& picture);

  // Records: the surface as seen from where fuse() was last, and what goes on there between frames: cleaning.
  void clean_and_predict(const PictureUse& picture);

  // Records: the surface of the active submaps as seen from `world_from_camera`, for a camera that is lost there.
  void predict(const Rigid3& world_from_camera, const MapLayout& layout);

  // What goes from one frame to the next, after submit_and_wait(): the map, the prediction and the last picture. restore() is of a front
  // end that has seen no frame; after a failure of the reader, or a throw of the store, it is of no use any more.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

  gpu::Device device;
  gpu::Commands commands;

 private:
  std::uint32_t max_slots() const;
  bool bring(const SubmapSet& needed, const MapLayout& layout);
  bool has_room(const MapLayout& layout);
  bool make_room(const MapLayout& layout);
  Eigen::Quaterniond turn_since_last(const std::optional<FeatureMotion>& followed);
  std::vector<Rigid3> guesses(const Rigid3& turned, const Rigid3& last_motion, const FeatureMotion* corners) const;
  CoarseMask beside_object(const CornerVerdict& seen);
  bool is_in(const CoarseMask& mask, const Eigen::Vector2d& pixel) const;
  bool waits_for_object(const CornerVerdict& seen) const;
  CoarseMask hidden_by_corners(const CornerVerdict& seen);
  OdometryResult align(const std::vector<Rigid3>& starts, const FeatureMotion* corners, const CoarseMask& hidden,
                       const Rigid3& world_from_reference, int lost_count);
  void remember_corners(const PictureFeatures& features, const DepthImage& depth);
  void use_shading();
  void hide(const CoarseMask& mask);
  void show(const Rigid3& world_from_camera, const SubmapSet& submaps);

  const Options options_;
  const Camera camera_;
  SensorNoise noise_;  // of the frames so far
  Preprocessor preprocessor_;
  Odometry odometry_;
  PictureFeatures last_features_;  // of the last frame that was tracked
  CornerTracks corner_tracks_;     // up to that
  CornerPoints corner_points_;     // of the same frame
  MovingRegions moving_;
  EarlierView earlier_;  // that the lens is learned by: as measured
  LensShading shading_;
  Rigid3 room_from_camera_;  // when an object is scanned: since it was last seen anew
  MapCertainty certainty_;
  CoarseView view_;         // of the frame preprocessed last
  CoarseMask moving_mask_;  // of the same
  VisibleBlocks visible_;
  IndexMap index_;
  Fuser fuser_;
  Predictor predictor_;

 public:
  SurfelStore store;               // the last to be made: it may take what the others leave
  std::uint32_t frame_number = 0;  // of the map: frames fused so far, the first is 1

 private:
  std::uint32_t submap_ = 0;            // of the new surfels that came last
  std::uint32_t full_until_frame_ = 0;  // of the map: before that one nobody asks again whether there is room
};

}  // namespace hermite
