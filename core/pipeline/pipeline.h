// HRBF-Fusion for one scan: frames in, poses and a surfel model out. See `process` in pipeline.cpp for the method in one sentence.
//
// A pipeline belongs to one thread at a time, but for prepare(). Same frames, options and device: the same poses and cloud, bit for bit.
// The world is the first tracked frame's camera.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
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

namespace hermite {

// One observation straight from the front. Of a furnished room with a Kinect's noise, meshes of surfels from here on reach 95.8 % of what
// was seen within 10 mm, with a mean error of 1.84 mm; of stable ones only (3) 87.2 % and 1.61; of all 97.4 % and 1.97.
inline constexpr float kMeshedConfidence = 1;

struct SubmapPose {
  std::uint32_t submap = 0;
  Rigid3 world_from_submap;
  std::uint32_t component = 0;  // see MapLayout; the pose relative to submaps of other components says nothing
};

struct PipelineStatistics {
  std::int64_t frame_count = 0;
  std::int64_t tracked_frame_count = 0;  // weakly tracked ones included
  std::int64_t weak_frame_count = 0;
  double position_sigma_m = 0, rotation_sigma_rad = 0;  // of the last tracked frame
  std::string calibration_doubt;                        // in words; empty: the camera fits what it has seen
  std::string camera_correction;                        // in words; empty: the camera is taken as it was given
  std::optional<Camera> corrected_camera;               // when it is not
  std::int64_t surfel_count = 0;
  std::int64_t surfel_slot_count = 0;                    // in use or free again
  std::int64_t surfel_capacity = 0;                      // slots there is memory for
  double mean_frame_ms = 0;                              // wall clock inside process(); this and the next two since restore()
  std::map<std::string, double> stages_ms;               // mean per frame, by stage
  std::map<std::string, double> gpu_passes_ms;           // mean per frame, by shader; GPU time stamps
  std::map<std::string, std::int64_t> gpu_memory_bytes;  // by purpose
  std::int64_t device_memory_bytes = 0;                  // that the device has in all; 0: nobody knows, it is a processor
  std::int64_t host_memory_bytes = 0;                    // of submaps that wait there
  std::optional<MappingCounts> mapping;                  // none without mapping
  std::string device;
};

// A frame that was given, as it was; asked for from the first one on, once each, in their order, on any one thread. An error: it counts as
// one that shows nothing.
using PastFrames = std::function<Result<RgbdFrame>(std::int64_t frame_index, double timestamp_s)>;

// What a pipeline takes from others, on the thread that calls process() or finish().
struct BackEnd {
  // For a camera: the one given first, then each that it is corrected to. None: there is one submap, no loop is closed and a lost camera is
  // only searched for where it was last.
  std::function<std::unique_ptr<Mapping>(const Camera& camera)> mapping;
  // None: the camera is taken as it is.
  std::function<std::unique_ptr<CameraWatch>(const Camera& camera)> camera_watch;
  // All frames so far. None: a camera that is off is not corrected, and frames are weak.
  std::function<PastFrames()> past_frames;
};

class Pipeline {
 public:
  // `device` selects the GPU: empty for the best one, an index, or part of a name. Throws SetupError: no such device, too little memory,
  // bad camera. A `timeline`, which outlives this, gets every stage and every GPU pass.
  Pipeline(const std::string& device, const Camera& camera, const Options& options, BackEnd back_end, Timeline* timeline = nullptr);

  // With one mapping, and so with the camera as it is.
  Pipeline(const std::string& device, const Camera& camera, const Options& options, std::unique_ptr<Mapping> mapping = nullptr,
           Timeline* timeline = nullptr);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  // What needs neither the device nor the frames before: straightening, registering. For any thread, while this works on another frame.
  // kInvalidArgument: of another size than the camera's.
  Result<PreparedFrame> prepare(RgbdFrame frame) const;

  // Never fails because of what a frame contains: a frame that cannot be used is kLost, with a reason. When the map is full (as
  // map.gpu_memory_mb has it, or the device), frames are tracked and continue the surfels that exist, and are kWeak. Where the camera turns
  // out to be off, all frames so far are worked through again with a better one before this returns (MapEvent::kRecalibrated).
  // `prepared` is of a pipeline with the same camera and options. Error only for a frame of another size (kInvalidArgument) and for the
  // device (kDevice: lost or out of memory), after which only trajectory() and statistics() may be called.
  Result<FrameResult> process(const PreparedFrame& prepared);

  // Both.
  Result<FrameResult> process(RgbdFrame frame);

  // No frame follows: the map is adjusted for the last time. Throws SetupError: the device.
  void finish();

  // Adds an earlier model, in this scan's world frame: as if all of it were seen in the next frame. Normals towards the camera, as in
  // cloud(); points without confidence are left out. The camera is taken as it is from then on. kDevice: no room.
  Status insert(const Cloud& cloud);

  // All that has come of the frames so far, as bytes; takes time like copying the map, and waits for nothing. kDevice.
  Result<std::string> save() const;

  // Goes on from where save() was, to the same poses, cloud and changes as if nothing had been between, bit for bit. This has seen no
  // frame. kUnsupported: saved under other conditions (device, program, camera, options), in words. kCorruptData: not what save() made.
  // kDevice: no room. After an error this is of no use any more. Damage that leaves the bytes a possible state is not seen: whoever keeps
  // them adds a checksum.
  Status restore(std::string_view bytes);

  // One pose for every frame given, lost ones included, with the frame's own time stamp; all as the map lies now.
  const Trajectory& trajectory() const;

  // Of every frame, the same poses in the frames of their submaps.
  std::vector<AnchoredPose> anchored_poses() const;

  // Stable surfels (all of them with options.output_unstable), in the world frame, normals towards the camera.
  Result<Cloud> cloud();

  // The same with those less certain that a mesh is made of (kMeshedConfidence): a surface reaches farther than what each surfel of it is
  // certain of, since their neighbours say the same.
  Result<Cloud> surfels();

  // Slots that changed since the last call, in slot order, in submap frames: enough to keep a mirror of what surfels() would return, and so
  // of cloud(), which has those of them with at least least_output_confidence().
  Result<std::vector<SlotChange>> take_changes();

  // The next take_changes() is of everything: for a mirror that begins anew.
  void forget_taken_changes();

  std::vector<SubmapPose> submap_poses() const;
  PipelineStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
