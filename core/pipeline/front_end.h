// The GPU part of a scan: frames are tracked against the surface that the map predicts, and fused
// into it.
//
// Every function blocks until the GPU is done, except those that only record commands. One thread
// at a time, the device's.
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
#include "core/track/coarse_masks.h"
#include "core/track/last_corners.h"
#include "core/track/lens_shading.h"
#include "core/track/light_changes.h"
#include "core/track/map_certainty.h"
#include "core/track/moving_regions.h"
#include "core/track/new_light.h"
#include "core/track/odometry.h"

namespace hermite::pipeline {

// How a frame's colour image is used in the map.
struct ColorUse {
  map::ColorFusion fusion = map::ColorFusion::kMean;
  frame::Brightness brightness;
  bool is_good() const { return fusion != map::ColorFusion::kKeep; }
};

struct Motion {
  track::OdometryResult odometry;
  track::Judgement judgement;
};

// Returns what a frame that is judged so and not lost does to the colours of the map.
map::ColorFusion fusion_of_colors(const track::Judgement& judgement);

// Returns the layout as far as the uncertainty of poses depends on it, by reference.
track::MapCertainty::Ground ground_of(const adjust::MapLayout& layout);

class FrontEnd {
 public:
  FrontEnd(const std::string& device, const Camera& camera, const Options& options,
           Timeline* timeline);

  // Adds what a frame tells of the sensor's noise. Call it once for each frame, before it is
  // preprocessed.
  void learn_noise(const frame::PreparedFrame& frame) {
    noise_.add(frame.noise);
    steps_.add(frame.steps);
  }

  // Records only. A frame may be preprocessed and tracked again before the next one.
  void preprocess(const frame::RgbdFrame& frame, std::int64_t frame_index);

  // Tracks the last preprocessed frame, whose `corners` have been followed, against the prediction.
  // The resulting reference_from_camera is relative to the pose of the prediction,
  // `world_from_reference`. `lost_count` is the number of frames lost just before this one. Moving
  // regions of the frame are masked from here on.
  Motion track(const frame::PreparedFrame& frame, const track::CornerVerdict& seen,
               const Rigid3& world_from_reference, const Rigid3& last_motion, int lost_count);

  // Keeps the corners and the surface of the last preprocessed frame, which is not to be in the
  // map, for the next frame. Records only.
  void keep(const frame::PreparedFrame& frame, const adjust::MapLayout& layout);

  // Tracks the last preprocessed frame against the kept one. Returns kept_from_camera, or nullopt
  // if they do not fit.
  std::optional<Rigid3> motion_since_kept(const Rigid3& guess);

  // Returns `frame`, which is the last tracked one, without depth in its moving regions, as the
  // back end gets it; nullopt: nothing moves.
  std::optional<frame::RgbdFrame> without_moving(const frame::RgbdFrame& frame) const {
    return track::without_depth_in(moving_mask_, view_, frame);
  }

  // Keeps the last tracked frame, at this pose, as the reference for detecting motion and for
  // following corners. After a lost frame or a correction of the map forget_views() drops it; after
  // relocalisation, corners.forget_points() too.
  void remember_view(const Rigid3& world_from_camera, const Rigid3& reference_from_camera,
                     const frame::PreparedFrame& frame);
  void forget_views();

  // Returns the uncertainty of the last tracked frame's pose in `layout`. Call it once for each
  // frame that is not lost.
  track::PoseUncertainty uncertainty_at(const Rigid3& world_from_camera,
                                        const track::OdometryResult& step,
                                        track::MapCertainty::StepError error,
                                        const adjust::MapLayout& layout);
  track::CalibrationDoubt calibration_doubt() const { return certainty_.calibration(); }

  // What is known of the camera's calibration, and of the map's components.
  track::MapCertainty& certainty() { return certainty_; }
  const track::MapCertainty& certainty() const { return certainty_; }

  // Returns whether the frame shows enough surface to start a map or a component.
  track::Judgement judge_start(const frame::FrameContent& content);

  // Aligns the last preprocessed frame with the surface of the candidate's submaps; nullopt if they
  // do not fit. Replaces the prediction.
  std::optional<adjust::LoopVerification> verify(const adjust::LoopCandidate& candidate,
                                                 const adjust::MapLayout& layout);

  // Records the fusion of the last preprocessed frame, at `world_from_camera`, into the active
  // submaps; new surfels go to the current one. Returns false if the map is full and no surfels
  // were added.
  bool fuse(const Rigid3& world_from_camera, const adjust::MapLayout& layout,
            const ColorUse& color);

  // Records the cleaning of the map and the prediction of its surface at the pose of the last
  // fuse().
  void clean_and_predict(const ColorUse& color);

  // Records the prediction of the active submaps at `world_from_camera`, against which a lost
  // camera is tracked.
  void predict(const Rigid3& world_from_camera, const adjust::MapLayout& layout);

  // Saves the state between frames, after submit_and_wait(): map, prediction and last colour image.
  // restore() needs a front end that has seen no frame; after a failure of the reader or an
  // exception of the store, the object must not be used.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

  gpu::Device device;
  gpu::Commands commands;
  track::LastCorners corners;  // needs nothing of the GPU, so it can be used while that works

 private:
  frame::CoarseMask background_of_object(const track::CornerVerdict& seen);
  bool is_in_mask(const frame::CoarseMask& mask, const Eigen::Vector2d& pixel) const {
    return track::is_in(mask, view_, pixel, camera_);
  }
  frame::CoarseMask hidden_by_corners(const track::CornerVerdict& seen);
  track::OdometryResult align(const std::vector<Rigid3>& starts, const track::FeatureMotion* held,
                              const frame::CoarseMask& hidden, const Rigid3& world_from_reference,
                              int lost_count);
  void remember_corners(const frame::ImageFeatures& features, const DepthImage& depth);
  void use_shading();
  void follow_image(const track::Judgement& judgement, track::OdometryResult& found);
  void hide(const frame::CoarseMask& mask, const frame::CoarseMask& light);
  void predict_from(const Rigid3& world_from_camera, const map::SubmapSet& submaps,
                    map::FillIn fill_in = map::FillIn::kNothing);

  const Options options_;
  const Camera camera_;
  frame::SensorNoise noise_;  // estimated from the frames so far
  frame::SeenSteps steps_;    // likewise
  frame::Preprocessor preprocessor_;
  track::Odometry odometry_;
  track::MovingRegions moving_;
  track::LightChanges light_;
  track::NewLight new_light_;
  // As measured, before shading is corrected; lens shading is learned from it.
  track::EarlierView earlier_;
  track::LensShading shading_;
  double usual_information_ = 0;  // see TrackingEvidence
  // For scans of an object: camera pose since the object was last seen anew.
  Rigid3 room_from_camera_;
  track::MapCertainty certainty_;
  frame::CoarseView view_;         // of the last preprocessed frame
  track::ViewSurfaces surfaces_;   // of the same frame, once it is tracked
  frame::CoarseMask moving_mask_;  // of the same frame
  frame::CoarseMask light_mask_;   // of the same frame: where the light changes
  map::VisibleBlocks visible_;
  map::IndexMap index_;
  map::Fuser fuser_;
  map::Predictor predictor_;

 public:
  // Constructed last, because it may take the memory that the others leave.
  map::SurfelStore store;
  std::uint32_t frame_number = 0;  // frames fused so far; the first is 1

 private:
  MapMemory memory_;
};

}  // namespace hermite::pipeline
