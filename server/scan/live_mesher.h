// Makes the surface of a running scan for its viewers: a thread of low priority takes the changes
// of the map, contours the most urgent cubes first, and reports each piece immediately. It does not
// influence poses or the cloud.
//
// Bounds: 0.3 GB (core/mesh/live_surface.h), plus the changes that arrive while one cube is made;
// beyond that all pieces are reported as empty and the surface ends. Owned by one thread.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "core/mesh/live_surface.h"
#include "server/scan/scan_worker.h"

namespace hermite::pipeline {
class Pipeline;
}  // namespace hermite::pipeline

namespace hermite::server {

class LiveMesher {
 public:
  using Clock = std::chrono::steady_clock;

  // Changes since the last call; the first time the whole map.
  struct Model {
    std::vector<output::SlotChange> changes;
    std::vector<mesh::PlacedSubmap> submaps;
    Eigen::Vector3f eye_m = Eigen::Vector3f::Zero();  // in the world; cubes near it come first
    // When the first frame with these changes arrived at the server.
    Clock::time_point since;
  };

  // `tell` is called on the mesher's thread.
  explicit LiveMesher(std::function<void(MeshUpdate)> tell,
                      std::size_t most_surfels = mesh::kMostLiveSurfels);
  ~LiveMesher();  // waits for the current cube
  LiveMesher(const LiveMesher&) = delete;
  LiveMesher& operator=(const LiveMesher&) = delete;

  void add(Model model);
  void pause(bool paused);  // changes are kept, but nothing is contoured

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Connects the pipeline of a scan with its mesher, which is created when a viewer first wants a
// surface. Used by the worker's thread.
class MeshFeed {
 public:
  explicit MeshFeed(std::function<void(MeshUpdate)> tell) : tell_(std::move(tell)) {}

  void frame_taken(LiveMesher::Clock::time_point arrived);
  bool is_due(bool wanted, LiveMesher::Clock::time_point now) const;

  // Changes since the last call, for the mesher and the caller; the whole map when the mesher has
  // just been created. kDevice.
  Result<std::vector<output::SlotChange>> take_changes(pipeline::Pipeline& pipeline, bool wanted);

  void end() { mesher_.reset(); }  // the scan has ended

 private:
  const std::function<void(MeshUpdate)> tell_;
  std::unique_ptr<LiveMesher> mesher_;
  // The arrival of the first frame that was not reported yet.
  std::optional<LiveMesher::Clock::time_point> since_;
  LiveMesher::Clock::time_point taken_at_;
  LiveMesher::Clock::duration cost_{};  // of the last call
};

}  // namespace hermite::server
