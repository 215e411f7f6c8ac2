// The surface of a scan that runs, for those who watch it: a thread of low priority that takes what has changed, contours what is most
// wanted cube by cube, and tells each piece at once. It has no influence on poses or cloud.
//
// Bounds: 0.3 GB (core/mesh/live_surface.h), and what changes while one cube is made; beyond that all pieces are told as empty
// and the surface ends. The owner is one thread.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "core/mesh/live_surface.h"
#include "server/scan/scan_worker.h"

namespace hermite {

class Pipeline;

class LiveMesher {
 public:
  using Clock = std::chrono::steady_clock;

  // Since the last time; the first time all there is.
  struct Model {
    std::vector<SlotChange> changes;
    std::vector<PlacedSubmap> submaps;
    Eigen::Vector3f eye_m = Eigen::Vector3f::Zero();  // in the world: what is near there comes first
    Clock::time_point since;                          // when the first frame of these came to the server
  };

  // `tell` is called on the mesher's thread.
  explicit LiveMesher(std::function<void(MeshUpdate)> tell, std::size_t most_surfels = kMostLiveSurfels);
  ~LiveMesher();  // within the cube in work
  LiveMesher(const LiveMesher&) = delete;
  LiveMesher& operator=(const LiveMesher&) = delete;

  void add(Model model);
  void pause(bool paused);  // what has changed is kept, and nothing is contoured

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Between a scan's pipeline and its mesher, which begins when somebody wants a surface for the first time. For the worker's thread.
class MeshFeed {
 public:
  explicit MeshFeed(std::function<void(MeshUpdate)> tell) : tell_(std::move(tell)) {}

  void frame_taken(LiveMesher::Clock::time_point arrived);
  bool is_due(bool wanted, LiveMesher::Clock::time_point now) const;

  // What has changed since the last time, for the mesher and the caller. When the mesher begins it is all there is, once more. kDevice.
  Result<std::vector<SlotChange>> take_changes(Pipeline& pipeline, bool wanted);

  void end() { mesher_.reset(); }  // the scan is over

 private:
  const std::function<void(MeshUpdate)> tell_;
  std::unique_ptr<LiveMesher> mesher_;
  std::optional<LiveMesher::Clock::time_point> since_;  // of the first frame that was not told of
  LiveMesher::Clock::time_point taken_at_;
  LiveMesher::Clock::duration cost_{};  // of the last time
};

}  // namespace hermite
