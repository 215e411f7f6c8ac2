// The GPU part of a scan: frames are tracked against the surface that the map predicts, and fused into it.
//
// Every function blocks until the GPU is done, except those that only record commands. One thread at a time, the
// device's.
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
#include "core/pipeline/map_memory.h"
#include "core/pipeline/options.h"
#include "core/track/last_corners.h"
#include "core/track/lens_shading.h"
#include "core/track/light_changes.h"
#include "core/track/map_certainty.h"
#include "core/track/moving_regions.h"
#include "core/track/odometry.h"

namespace hermite {

// How a frame's colour image is used in the map.
struct ColorUse {
  bool is_good = true;
  Brightness brightness;
};

struct Motion {
  OdometryResult odometry;
  Judgement judgement;
};

// Returns the layout as far as the uncertainty of poses depends on it, by reference.
MapCertainty::Ground ground_of(const MapLayout& layout);

class FrontEnd {
 public:
  FrontEnd(const std::string& device, const Camera& camera, const Options& options, Timeline* timeline);

  // Adds what a frame tells of the sensor's noise. Call it once for each frame, before it is preprocessed.
  void learn_noise(const PreparedFrame& frame) {
    noise_.add(frame.noise);
    steps_.add(frame.steps);
  }

  // Records only. A frame may be preprocessed and tracked again before the next one.
  void preprocess(const RgbdFrame& frame, std::int64_t frame_index);

  // Tracks the last preprocessed frame, whose `corners` have been followed, against the prediction. The resulting
  // reference_from_camera is relative to the pose of the prediction, `world_from_reference`. `lost_count` is the number
  // of frames lost just before this one. Moving regions of the frame are masked from here on.
  Motion track(const PreparedFrame& frame, const CornerVerdict& seen, const Rigid3& world_from_reference, const Rigid3& last_motion,
               int lost_count);

  // Keeps the corners and the surface of the last preprocessed frame, which is not to be in the map, for the next frame.
  // Records only.
  void keep(const PreparedFrame& frame, const MapLayout& layout);

  // Tracks the last preprocessed frame against the kept one. Returns kept_from_camera, or nullopt if they do not fit.
  std::optional<Rigid3> motion_since_kept(const Rigid3& guess);

  // The moving regions of the last tracked frame, per coarse pixel, and its coarse surface.
  const CoarseMask& moving() const { return moving_mask_; }
  const CoarseView& coarse_view() const { return view_; }

  // Keeps the last tracked frame, at this pose, as the reference for detecting motion and for following corners. After
  // a lost frame or a correction of the map forget_views() drops it; after relocalisation, corners.forget_points() too.
  void remember_view(const Rigid3& world_from_camera, const Rigid3& reference_from_camera, const PreparedFrame& frame);
  void forget_views();

  // Returns the uncertainty of the last tracked frame's pose in `layout`. Call it once for each frame that is not lost.
  PoseUncertainty uncertainty_at(const Rigid3& world_from_camera, const OdometryResult& step, MapCertainty::StepError error,
                                 const MapLayout& layout);
  CalibrationDoubt calibration_doubt() const { return certainty_.calibration(); }

  // What is known of the camera's calibration, and of the map's components.
  MapCertainty& certainty() { return certainty_; }

  // Returns whether the frame shows enough surface to start a map or a component.
  Judgement judge_start(const FrameContent& content);

  // Aligns the last preprocessed frame with the surface of the candidate's submaps; nullopt if they do not fit.
  // Replaces the prediction.
  std::optional<LoopVerification> verify(const LoopCandidate& candidate, const MapLayout& layout);

  // Records the fusion of the last preprocessed frame, at `world_from_camera`, into the active submaps; new surfels go
  // to the current one. Returns false if the map is full and no surfels were added.
  bool fuse(const Rigid3& world_from_camera, const MapLayout& layout, const ColorUse& color);

  // Records the cleaning of the map and the prediction of its surface at the pose of the last fuse().
  void clean_and_predict(const ColorUse& color);

  // Records the prediction of the active submaps at `world_from_camera`, against which a lost camera is tracked.
  void predict(const Rigid3& world_from_camera, const MapLayout& layout);

  // Saves the state between frames, after submit_and_wait(): map, prediction and last colour image. restore() needs a
  // front end that has seen no frame; after a failure of the reader or an exception of the store, the object must not
  // be used.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

  gpu::Device device;
  gpu::Commands commands;
  LastCorners corners;  // needs nothing of the GPU, so it can be used while that works

 private:
  CoarseMask background_of_object(const CornerVerdict& seen);
  bool is_in(const CoarseMask& mask, const Eigen::Vector2d& pixel) const;
  CoarseMask hidden_by_corners(const CornerVerdict& seen);
  OdometryResult align(const std::vector<Rigid3>& starts, const FeatureMotion* held, const CoarseMask& hidden,
                       const Rigid3& world_from_reference, int lost_count);
  void remember_corners(const ImageFeatures& features, const DepthImage& depth);
  void use_shading();
  void hide(const CoarseMask& mask, const CoarseMask& light);
  void predict_from(const Rigid3& world_from_camera, const SubmapSet& submaps, FillIn fill_in = FillIn::kNothing);

  const Options options_;
  const Camera camera_;
  SensorNoise noise_;  // estimated from the frames so far
  SeenSteps steps_;    // likewise
  Preprocessor preprocessor_;
  Odometry odometry_;
  MovingRegions moving_;
  LightChanges light_;
  EarlierView earlier_;  // as measured, before shading is corrected; lens shading is learned from it
  LensShading shading_;
  double usual_information_ = 0;  // see TrackingEvidence
  Rigid3 room_from_camera_;       // for scans of an object: camera pose since the object was last seen anew
  MapCertainty certainty_;
  CoarseView view_;         // of the last preprocessed frame
  ViewSurfaces surfaces_;   // of the same frame, once it is tracked
  CoarseMask moving_mask_;  // of the same frame
  CoarseMask light_mask_;   // of the same frame: where the light changes
  VisibleBlocks visible_;
  IndexMap index_;
  Fuser fuser_;
  Predictor predictor_;

 public:
  SurfelStore store;               // constructed last, because it may take the memory that the others leave
  std::uint32_t frame_number = 0;  // frames fused so far; the first is 1

 private:
  MapMemory memory_;
};

// Returns the frame without depth in the moving regions of the last tracked frame, as the back end gets it; nullopt: nothing moves.
std::optional<RgbdFrame> without_moving(const RgbdFrame& frame, const FrontEnd& front_end);

}  // namespace hermite
