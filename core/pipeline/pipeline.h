// HRBF-Fusion for one scan: it takes frames and gives poses and a surfel model. core/METHOD.md
// explains the method.
//
// A pipeline belongs to one thread at a time, except prepare(). The same frames, options and device
// give the same poses and cloud, bit for bit. The world frame is the camera frame of the first
// tracked frame.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/timeline.h"
#include "core/calibrate/camera_watch.h"
#include "core/dataset/trajectory.h"
#include "core/frame/prepared_frame.h"
#include "core/math/camera.h"
#include "core/output/cloud.h"
#include "core/pipeline/frame_result.h"
#include "core/pipeline/options.h"
#include "core/pipeline/pipeline_statistics.h"
#include "core/pipeline/reason_table.h"

namespace hermite::pipeline {

// The confidence of one frontal observation. In a furnished room with a Kinect's noise, meshes of
// surfels with at least this confidence cover 95.8 % of the observed surface within 10 mm, with a
// mean error of 1.84 mm; of stable ones only (3), 87.2 % and 1.61; of all, 97.4 % and 1.97.
inline constexpr float kMeshedConfidence = 1;

struct SubmapPose {
  std::uint32_t submap = 0;
  Rigid3 world_from_submap;
  std::uint32_t component = 0;  // see MapLayout; poses are not comparable across components
};

// Returns a past frame exactly as it was given. Called on one thread, once per frame in order,
// starting with the first. A frame whose read fails is processed as one without content.
using PastFrames =
    std::function<Result<frame::RgbdFrame>(std::int64_t frame_index, double timestamp_s)>;

// What a pipeline gets from its caller. The functions are called on the thread that calls process()
// or finish().
struct BackEnd {
  // Makes a mapping for a camera: the given one, then each corrected one. Empty: there is one
  // submap, no loop is closed, and a lost camera is only searched for at its last pose.
  std::function<std::unique_ptr<adjust::Mapping>(const Camera& camera)> mapping;
  // Empty: the camera is used as given.
  std::function<std::unique_ptr<calibrate::CameraWatch>(const Camera& camera)> camera_watch;
  // Gives access to all frames so far. Empty: a camera that is off is not corrected, and frames are
  // weak.
  std::function<PastFrames()> past_frames;
};

class Pipeline {
 public:
  // `device` selects the GPU: empty for the best one, an index, or part of a name. `timeline` must
  // outlive this object; it gets every stage and every GPU pass. Throws SetupError for an unknown
  // device, too little memory or an invalid camera.
  Pipeline(const std::string& device, const Camera& camera, const Options& options,
           BackEnd back_end, Timeline* timeline = nullptr);

  // With one given mapping; the camera is used as given.
  Pipeline(const std::string& device, const Camera& camera, const Options& options,
           std::unique_ptr<adjust::Mapping> mapping = nullptr, Timeline* timeline = nullptr);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // Does the work that needs neither the device nor previous frames: rectification and
  // registration. Any thread, also while another frame is processed. Returns kInvalidArgument when
  // the frame has another size than the camera.
  Result<frame::PreparedFrame> prepare(frame::RgbdFrame frame) const;

  // Processes a frame, prepared by a pipeline with the same camera and options. The content of a
  // frame never causes an error: a frame that cannot be used is kLost, with a reason. When the map
  // is full (by map.gpu_memory_mb or the device), frames are still tracked and update existing
  // surfels, and are kWeak. When the calibration turns out to be off, all frames so far are
  // reprocessed with a better one before this returns (MapEvent::kRecalibrated). Returns
  // kInvalidArgument for a frame of another size, and kDevice when the device is lost or out of
  // memory; after that only trajectory() and statistics() may be called.
  Result<FrameResult> process(const frame::PreparedFrame& prepared);

  // Prepares and processes a frame.
  Result<FrameResult> process(frame::RgbdFrame frame);

  // Call after the last frame: adjusts the map for the last time. Throws SetupError when the device
  // fails.
  void finish();

  // Adds an earlier model in this scan's world frame, as if all of it were seen in the next frame.
  // Normals point towards the camera, as in cloud(); points without confidence are skipped. The
  // calibration is not corrected from then on. Returns kDevice when there is no memory.
  Status insert(const output::Cloud& cloud);

  // Returns the complete state as bytes. Takes as long as copying the map; does not wait for a
  // running adjustment. Returns kDevice when the device fails.
  Result<std::string> save() const;

  // Continues from a state of save() with the same poses, cloud and changes as an uninterrupted
  // run, bit for bit. This pipeline must have seen no frame. Returns kUnsupported, naming the
  // difference, when the state was saved under other conditions (device, program, camera, options);
  // kCorruptData when save() did not write it; kDevice when there is no memory. After an error this
  // object must not be used. Damage that leaves a valid state is not detected, so whoever stores
  // the bytes adds a checksum.
  Status restore(std::string_view bytes);

  // One pose for every frame given, lost ones included, with the frame's own timestamp, at the
  // current layout of the map.
  const dataset::Trajectory& trajectory() const;

  // The same poses for every frame, in the frames of their submaps.
  std::vector<AnchoredPose> anchored_poses() const;

  // Why frames were weak or lost, by the numbers of their anchored poses. Valid until the next
  // frame.
  const ReasonTable& reasons() const;

  // Returns the stable surfels (all of them with options.output_unstable) in the world frame, with
  // normals towards the camera.
  Result<output::Cloud> cloud();

  // Returns also the less certain surfels that a mesh is made of (kMeshedConfidence): neighbouring
  // surfels support each other, so a surface extends beyond its stable surfels.
  Result<output::Cloud> surfels();

  // Returns the slots changed since the last call, in slot order and submap frames. They suffice to
  // mirror the result of surfels(), and of cloud(), which has those with at least
  // least_output_confidence().
  Result<std::vector<output::SlotChange>> take_changes();

  // The next take_changes() returns everything, for a mirror that starts anew.
  void forget_taken_changes();

  std::vector<SubmapPose> submap_poses() const;
  PipelineStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::pipeline
