// The back end of a scan: which submaps there are and where they lie, what the camera may have come back to, and where a lost one may be.
//
// The front end (core/pipeline) tracks the camera densely and owns the surfels; the back end sees keyframes, never a GPU. What it believes
// to recognise is a guess until the front end has looked: a Revisit is shown to the camera, and only what fits there is confirmed.
//
// One thread at a time; adjustment runs on a helper thread inside. In batch mode everything that comes back depends on the frames alone.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/adjust/adjust_options.h"
#include "core/base/byte_stream.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// By submap.
struct MapLayout {
  std::vector<Rigid3> world_from_submap{Rigid3{}};
  std::vector<bool> is_active{true};  // tracked against and fused into
  // Of submaps whose poses are known relative to each other. The camera was lost between parts; they are joined when one meets the other.
  std::vector<std::uint32_t> part{0};
  std::uint32_t current = 0;           // new surfels belong to it
  std::uint64_t correction_count = 0;  // times that submaps were moved
  std::uint64_t closure_count = 0;     // times that a loop was closed or a part joined
};

// Perhaps the camera sees known ground that is not active.
struct Revisit {
  Rigid3 world_from_camera;    // where it would be
  std::vector<bool> submaps;   // by submap: those to look at from there
  bool by_appearance = false;  // recognised; otherwise only near
};

// What the front end has seen of a revisit.
struct Look {
  Rigid3 world_from_camera;  // from where the frame shows what the revisit shows
  double overlap = 0;        // share of the frame's surface, 0 to 1, that falls onto that ground
};

enum class CorrectionTime { kByFrames, kWhenReady };  // batch, live

class Mapping {
 public:
  virtual ~Mapping() = default;

  virtual const MapLayout& layout() const = 0;

  // A tracked frame, rectified, before it is fused; `world_from_camera` in the present layout. May change the layout: results of adjustment
  // are applied, submaps opened. The camera's pose relative to the submap that was current stays what it is.
  virtual std::vector<Revisit> observe(const RgbdFrame& frame, const Rigid3& world_from_camera) = 0;

  // The frame observed last fits the revisit. Corrects the layout, at once or in one of the next calls of observe() or confirm(), when the
  // camera has seen as much of the place as it will. Or refuses: then the correction would be more than the camera can have drifted by, or
  // contradicts what else is known.
  virtual bool confirm(const Revisit& revisit, const Look& look) = 0;

  // Where a lost camera may be, likeliest first.
  virtual std::vector<Revisit> find(const RgbdFrame& frame) = 0;

  // The lost camera is at `world_from_camera`, where it sees what the revisit shows.
  virtual void found(const Revisit& revisit, const Rigid3& world_from_camera) = 0;

  // The camera was not found: the map goes on in a part of its own, whose first submap stands at `world_from_camera` until it is joined.
  virtual void begin_part(const Rigid3& world_from_camera) = 0;

  // No frame follows: what is being adjusted is awaited, and if a loop was closed everything is adjusted once more.
  virtual void finish() = 0;

  // For the report: "submaps", "keyframes", "landmarks", "loops", ...
  virtual std::map<std::string, std::int64_t> counts() const = 0;

  // All of it, between frames. Does not wait for an adjustment that is running.
  virtual void save(ByteWriter& bytes) const = 0;

  // Of a mapping of the same camera, options and time that has seen no frame. After a failure of the reader it is of no use any more.
  virtual void restore(ByteReader& bytes) = 0;
};

// `camera` is that of frames as they arrive.
std::unique_ptr<Mapping> make_mapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time);

}  // namespace hermite
