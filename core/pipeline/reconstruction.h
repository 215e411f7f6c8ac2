// Turns the frames of one camera into poses and a map. core/METHOD.md explains the method. One
// thread at a time, the device's.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/byte_stream.h"
#include "core/base/timeline.h"
#include "core/calibrate/camera_watch.h"
#include "core/frame/prepared_frame.h"
#include "core/pipeline/camera_pace.h"
#include "core/pipeline/felt_gravity.h"
#include "core/pipeline/frame_poses.h"
#include "core/pipeline/frame_result.h"
#include "core/pipeline/front_end.h"
#include "core/pipeline/options.h"
#include "core/pipeline/reason_table.h"
#include "core/pipeline/rolling_shutter.h"

namespace hermite::pipeline {

// Used by Pipeline, which replaces it when the calibration turns out to be off.
struct Reconstruction {
  Reconstruction(const std::string& device, const Camera& camera, const Options& options_of_scan,
                 std::unique_ptr<adjust::Mapping> mapping_of_scan,
                 std::unique_ptr<calibrate::CameraWatch> watch_of_camera,
                 Timeline* timeline_of_scan)
      : options(options_of_scan),
        timeline(timeline_of_scan),
        mapping(std::move(mapping_of_scan)),
        watch(std::move(watch_of_camera)),
        front_end(device, camera, options, timeline),
        shutter(front_end.device, camera, options.frame) {}

  FrameResult process(const frame::PreparedFrame& taken);

  // Call after the last frame: adjusts the map for the last time.
  void finish();

  // Call between frames. restore() needs an object that has seen no frame; after a failure of the
  // reader the object must not be used.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

  const adjust::MapLayout& layout() const { return mapping ? mapping->layout() : one_submap; }
  bool is_output(const map::Surfel& surfel) const {
    return surfel.confidence >= least_output_confidence(options);
  }

  // The steps of the functions above.
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved);
  MapEvent observe(const frame::RgbdFrame& frame, const Rigid3& tracked);
  MapEvent relocalise(const frame::PreparedFrame& prepared, track::SightGap& gap, Motion& motion);
  double reach_m(double timestamp_s) const;
  double jump_m(const adjust::LoopCandidate& candidate,
                const adjust::LoopVerification& verified) const;
  void judge_uncertainty(const frame::RgbdFrame& frame, const track::SightGap& gap, Motion& motion,
                         FrameResult& result);
  std::optional<RollingShutter::Corrected> in_one_instant(const frame::PreparedFrame& taken,
                                                          std::int64_t frame_index);
  std::optional<RollingShutter::Corrected> corrected_by(
      const Motion& motion, const frame::PreparedFrame& taken,
      const std::optional<RollingShutter::Corrected>& before);
  Motion track(const frame::PreparedFrame& prepared, std::int64_t frame_index);
  void track_and_fuse(const frame::PreparedFrame& taken, FrameResult& result);
  void wait_for_velocity(const frame::PreparedFrame& taken, FrameResult& result);
  // Returns the time since the last tracked frame, without what is usual between two frames.
  double unseen_s(double timestamp_s) const {
    return poses.size() < 2 ? 0 : pace.unseen_s(timestamp_s);
  }
  bool is_repeated(const frame::PreparedFrame& taken) const;
  Rigid3 coast(double repeated_share, FrameResult& result);
  void step(double timestamp_s, const Rigid3& last_from_camera, bool is_corrected);
  void offer_to_watch(const frame::RgbdFrame& frame, MapEvent event);

  // Runs `work`, waits for the GPU, and adds the wall clock time to `stage`.
  template <class Work>
  void timed(const char* stage, Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    front_end.commands.submit_and_wait();
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    stage_total_ms[stage] += ms;
    if (timeline) timeline->stages.push_back({stage, start, ms});
  }

  const Options options;
  Timeline* const timeline;                             // may be null
  const std::unique_ptr<adjust::Mapping> mapping;       // null: one submap, which never moves
  const std::unique_ptr<calibrate::CameraWatch> watch;  // null: the camera is used as given
  const adjust::MapLayout one_submap;
  FrontEnd front_end;
  RollingShutter shutter;

  // Camera pose of the last tracked frame; the pose of the prediction.
  Rigid3 world_from_camera;
  Rigid3 last_motion;  // reference_from_camera of the last tracked frame
  CameraPace pace;
  int lost_count = 0;                  // frames lost since the last tracked one
  int unplaced_count = 0;              // those of them that show enough to begin a map
  std::int64_t known_keyframes = 0;    // keyframes made before the last gap in sight
  track::PoseUncertainty uncertainty;  // of the last tracked frame
  std::uint64_t last_depth_digest = 0;
  FramePoses poses;
  ReasonTable reasons;  // of poses
  FeltGravity gravity;
  std::int64_t tracked_frame_count = 0, weak_frame_count = 0;
  // Frames counted by the next two and by the device's clocks, since restore().
  std::int64_t timed_frame_count = 0;
  double total_ms = 0;
  std::map<std::string, double> stage_total_ms;
};

}  // namespace hermite::pipeline
