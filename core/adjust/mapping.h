// The back end of a scan: which submaps there are and where they lie, which loops the camera may have closed, and where a lost one may be.
//
// The front end (core/pipeline) tracks the camera densely and owns the surfels; the back end sees keyframes, never a GPU. A place that it
// recognises is a loop candidate until the front end has verified it by aligning the frame with the surface there.
//
// One thread at a time; adjustment runs on a helper thread inside. In batch mode everything that comes back depends on the frames alone.
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

namespace hermite {

// By submap.
struct MapLayout {
  std::vector<Rigid3> world_from_submap{Rigid3{}};
  std::vector<bool> is_active{true};  // tracked against and fused into
  // Submaps of one component have poses that are known relative to each other. The camera was lost between two components; they are joined
  // when it sees both.
  std::vector<std::uint32_t> component{0};
  std::uint32_t current = 0;           // new surfels belong to it
  std::uint64_t correction_count = 0;  // times that submaps were moved
  std::uint64_t closure_count = 0;     // times that a loop was closed or a component joined
};

// The camera may see known ground that is not active.
struct LoopCandidate {
  Rigid3 world_from_camera;    // where it would be
  std::vector<bool> submaps;   // by submap: those to predict the surface from
  bool by_appearance = false;  // recognised; otherwise only near
};

// The frame was aligned with the surface of a candidate.
struct LoopVerification {
  Rigid3 world_from_camera;  // by the alignment
  double overlap = 0;        // share of the frame's surface, 0 to 1, that falls onto that ground
};

enum class CorrectionTime { kByFrames, kWhenReady };  // batch, live

class Mapping {
 public:
  virtual ~Mapping() = default;

  virtual const MapLayout& layout() const = 0;

  // A tracked frame, rectified, before it is fused; `world_from_camera` in the present layout. May change the layout: results of adjustment
  // are applied, submaps opened. The camera's pose relative to the submap that was current stays what it is.
  virtual std::vector<LoopCandidate> observe(const RgbdFrame& frame, const Rigid3& world_from_camera) = 0;

  // The frame observed last was aligned with the candidate. True: the loop is closed, at once or in one of the next calls of observe() or
  // confirm(), when the camera has seen as much of the place as it will. False: the correction would be more than the camera can have
  // drifted by, or contradicts what else is known, and nothing has changed.
  virtual bool confirm(const LoopCandidate& candidate, const LoopVerification& verified) = 0;

  // Candidates for where a lost camera is, likeliest first.
  virtual std::vector<LoopCandidate> relocalise(const RgbdFrame& frame) = 0;

  // The lost camera is at `world_from_camera`, by alignment with the candidate.
  virtual void relocalised(const LoopCandidate& candidate, const Rigid3& world_from_camera) = 0;

  // The camera was not found: the map goes on in a new component, whose first submap stands at `world_from_camera` until it is joined.
  virtual void begin_component(const Rigid3& world_from_camera) = 0;

  // No frame follows: what is being adjusted is awaited, and if a loop was closed everything is adjusted once more.
  virtual void finish() = 0;

  virtual MappingCounts counts() const = 0;

  // All of it, between frames. Does not wait for an adjustment that is running.
  virtual void save(ByteWriter& bytes) const = 0;

  // Of a mapping of the same camera, options and time that has seen no frame. After a failure of the reader it is of no use any more.
  virtual void restore(ByteReader& bytes) = 0;
};

inline std::size_t component_count(const MapLayout& layout) { return std::set(layout.component.begin(), layout.component.end()).size(); }

// `camera` is that of frames as they arrive.
std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time);

}  // namespace hermite
