// The back end of a scan: it decides which submaps exist and where they lie, proposes loop
// candidates, and relocalises a lost camera.
//
// The front end (core/pipeline) tracks the camera densely and owns the surfels; the back end sees
// only keyframes and never uses the GPU. A recognised place is a loop candidate until the front end
// has verified it by aligning the frame with the surface there.
//
// One thread at a time; adjustment runs on an internal helper thread. In batch mode, all results
// depend on the frames alone.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "core/adjust/adjust_options.h"
#include "core/adjust/mapping_counts.h"
#include "core/base/byte_stream.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::adjust {

// The submaps as the front end sees them. Vectors are indexed by submap.
struct MapLayout {
  std::vector<Rigid3> world_from_submap{Rigid3{}};
  // The camera is tracked against it and frames are fused into it.
  std::vector<bool> is_active{true};
  // The poses of submaps of one component are known relative to each other. Between two components
  // the camera was lost; they are joined when it sees both.
  std::vector<std::uint32_t> component{0};
  std::uint32_t current = 0;           // new surfels belong to this submap
  std::uint64_t correction_count = 0;  // how often submaps were moved
  std::uint64_t closure_count = 0;     // how often a loop was closed or a component joined
};

// An inactive part of the map that the camera may see.
struct LoopCandidate {
  Rigid3 world_from_camera;    // the camera's pose if the candidate is right
  std::vector<bool> submaps;   // submaps from which to predict the surface
  bool by_appearance = false;  // recognised by features; otherwise only near by its pose
};

// The result of aligning the frame with the surface of a candidate.
struct LoopVerification {
  Rigid3 world_from_camera;  // as aligned
  // Share of the frame's surface, 0 to 1, that lies on the candidate's surface.
  double overlap = 0;
};

enum class CorrectionTime { kByFrames, kWhenReady };  // batch, live

class Mapping {
 public:
  virtual ~Mapping() = default;

  virtual const MapLayout& layout() const = 0;

  // Takes a tracked, rectified frame before it is fused, with its pose in the present layout, and
  // returns loop candidates. The layout may change: results of adjustment are applied and submaps
  // are opened. The camera's pose relative to the submap that was current does not change.
  virtual std::vector<LoopCandidate> observe(const frame::RgbdFrame& frame,
                                             const Rigid3& world_from_camera) = 0;

  // Reports that the last observed frame was aligned with the candidate. Returns true if the loop
  // is closed, at once or in a later call of observe() or confirm() when the camera no longer sees
  // more of the place. Returns false, with nothing changed, if the correction exceeds the possible
  // drift or contradicts other links.
  virtual bool confirm(const LoopCandidate& candidate, const LoopVerification& verified) = 0;

  // Returns candidates for the pose of a lost camera, most likely first.
  virtual std::vector<LoopCandidate> relocalise(const frame::RgbdFrame& frame) = 0;

  // Returns whether the image of a camera at `world_from_camera` shows what the map has there, and
  // not elsewhere as well, by landmarks that one of the first `known_keyframes` keyframes has seen
  // (repetition.h). True if places are not recognised.
  virtual bool is_distinctive(const frame::RgbdFrame& frame, const Rigid3& world_from_camera,
                              std::int64_t known_keyframes) const = 0;

  // Reports that the lost camera is at `world_from_camera`, after alignment with the candidate.
  virtual void relocalised(const LoopCandidate& candidate, const Rigid3& world_from_camera) = 0;

  // Starts a new component, because the camera was not relocalised. Its first submap is placed at
  // `world_from_camera`, the last known pose, until the component is joined, and can be `reach_m`
  // from there.
  virtual void begin_component(const Rigid3& world_from_camera, double reach_m) = 0;

  // Call after the last frame. Waits for a running adjustment and, if a loop was closed, adjusts
  // everything once more.
  virtual void finish() = 0;

  virtual MappingCounts counts() const = 0;

  // Saves the complete state between frames. Does not wait for a running adjustment.
  virtual void save(ByteWriter& bytes) const = 0;

  // Restores a state saved with the same camera, options and time into a mapping that has seen no
  // frame. After a failure of the reader this object must not be used.
  virtual void restore(ByteReader& bytes) = 0;
};

inline std::size_t component_count(const MapLayout& layout) {
  return std::set(layout.component.begin(), layout.component.end()).size();
}

// Creates the back end; nullptr if the options turn off all adjustment. `camera` is that of the
// unrectified frames.
std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options,
                                      CorrectionTime time);

}  // namespace hermite::adjust
