// The viewers of one scan and what they are sent. Instead of a queue each viewer has a set of
// chunks that it lacks: a slow viewer skips versions, a late one starts with all chunks in the set,
// and memory is bounded by the size of the model. Chunks that a viewer does not want to see stay in
// its set, so that it gets them when it changes its mind.
//
// Messages are formatted once and shared. Everything belongs to the network thread.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/output/chunks.h"
#include "proto/wire/messages.h"
#include "server/scan/scan_worker.h"
#include "server/store/shares.h"

namespace hermite::server {

// Viewers of one scan. A share link counts as one token however many people open it: one link may
// take half of the places.
inline constexpr Share kViewerShare{32, 16, 4};
// Chunks and pieces wait while, with them, more than this would not be acknowledged.
inline constexpr std::uint64_t kMaxUnackedBytes = 4 * 1024 * 1024;

struct SceneInfo {
  std::string scan_id;
  std::string title;
  Camera camera;
};

// The credentials of a viewer.
struct ViewerToken {
  std::string token_id;
  bool is_admin = false;
};

// The formatted message of the newest version of a chunk of points or a piece of the surface.
struct ShownPart {
  SharedBytes message;
  bool empty = false;
};

// The parts of one kind that a viewer lacks.
template <class Key>
class MissingParts {
 public:
  using Parts = std::map<Key, ShownPart>;

  explicit MissingParts(const Parts& parts) {
    for (const auto& [key, part] : parts)
      if (!part.empty) missing_.insert(key);
    snapshot_ = missing_;
  }

  void add(const Key& key) { missing_.insert(key); }
  bool empty() const { return missing_.empty(); }
  // Everything that existed when the viewer came has been sent.
  bool has_snapshot() const { return snapshot_.empty(); }

  // Takes the keys in rotation rather than always from the front, so that parts that change all the
  // time do not starve the others. Must not be empty.
  Key next() const {
    auto chosen = last_ ? missing_.upper_bound(*last_) : missing_.begin();
    return chosen == missing_.end() ? *missing_.begin() : *chosen;
  }
  void sent(const Key& key) {
    missing_.erase(key);
    snapshot_.erase(key);
    last_ = key;
  }

 private:
  std::set<Key> missing_, snapshot_;
  std::optional<Key> last_;
};

class Viewer;

class Subscribers {
 public:
  explicit Subscribers(SceneInfo info) : info_(std::move(info)) {}
  Subscribers(const Subscribers&) = delete;
  Subscribers& operator=(const Subscribers&) = delete;

  const SceneInfo& info() const { return info_; }
  void rename(const std::string& title) { info_.title = title; }  // for viewers that come later

  void show_state(const wire::ScanState& state);
  // Also adds its position to the trajectory.
  void show_result(const wire::FrameResult& result);
  // Shows the poses of frames without reported results; they precede all others.
  void show_past(const std::vector<wire::PoseInSubmap>& poses);
  // Replaces all positions so far, when the map was rebuilt.
  void show_other_past(const std::vector<wire::PoseInSubmap>& poses);
  void show_poses(wire::SubmapPoses poses);
  void show_model(ModelUpdate update);
  void show_mesh(MeshUpdate update);  // when the surface has ended, all viewers see points

  // Called at once and on every change with whether any viewer wants a surface; nullptr: no
  // callback.
  void tell_mesh_wanted(std::function<void(bool)> tell);

  // For a scan that has ended: positions in the world, which no longer change.
  void set_positions(std::vector<float> positions_m) {
    final_positions_m_ = std::move(positions_m);
  }

  // The scan has ended and its final state and model were set: viewers are done once they have
  // everything.
  void close();

  std::size_t viewer_count() const { return viewers_.size(); }

  // `wake` is called when there may be something to send to the viewer. kBusy: the token has its
  // share of viewers already.
  static Result<std::unique_ptr<Viewer>> join(const std::shared_ptr<Subscribers>& subscribers,
                                              const ViewerToken& token, const wire::Watch& watch,
                                              std::function<void()> wake);

 private:
  friend class Viewer;
  void wake_all();
  void ask_for_mesh();
  void add_position(const wire::PoseInSubmap& where);
  wire::TrajectoryPart trajectory() const;

  SceneInfo info_;
  SharedBytes state_, poses_, result_;
  std::map<output::ChunkKey, ShownPart> chunks_;
  std::map<mesh::SurfaceCube, ShownPart> pieces_;  // pieces of the surface
  bool mesh_ended_ = false;
  bool mesh_wanted_ = false;
  std::function<void(bool)> tell_mesh_wanted_;
  // The position of every result, in the frame of its submap, so that corrections move it.
  std::vector<float> positions_in_submaps_m_;  // x y z
  std::vector<std::uint32_t> submaps_;
  std::map<std::uint32_t, Rigid3> world_from_submap_;
  std::vector<float> final_positions_m_;  // x y z
  bool closed_ = false;
  std::set<Viewer*> viewers_;
};

// One viewer: decides what it is sent next. The subscribers outlive it.
class Viewer {
 public:
  Viewer(std::shared_ptr<Subscribers> subscribers, std::string token_id, const wire::Watch& watch,
         std::function<void()> wake);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // The next message; call it when the socket is free. None: nothing to send, or more than
  // kMaxUnackedBytes are not acknowledged.
  SharedBytes next();

  // What the viewer wants to see from now on, while the scan runs.
  void watch(const wire::Watch& watch);

  // Acknowledged bytes. kInvalidArgument: more than was sent.
  Status acknowledge(std::uint64_t bytes);

  // The scan has ended and everything was sent.
  bool complete() const;

  // Counts the bytes of a message that was sent elsewhere (Welcome, Pong), since the viewer
  // acknowledges them too.
  void count_sent(std::size_t bytes) { sent_bytes_ += bytes; }

 private:
  friend class Subscribers;
  bool sees_points() const;
  bool sees_mesh() const { return watch_.mesh; }
  template <class Key>
  SharedBytes next_part(const std::map<Key, ShownPart>& parts, MissingParts<Key>& missing);
  SharedBytes counted(SharedBytes message);

  const std::shared_ptr<Subscribers> subscribers_;
  const std::string token_id_;
  const std::function<void()> wake_;
  SharedBytes state_, poses_, result_, trajectory_;  // the newest, if not sent yet
  // The newest result with an event, sent even if a newer one has none.
  SharedBytes event_;
  wire::Watch watch_;
  MissingParts<output::ChunkKey> chunks_;
  MissingParts<mesh::SurfaceCube> pieces_;
  bool snapshot_ended_ = false;
  std::uint64_t sent_bytes_ = 0, acknowledged_bytes_ = 0;
};

}  // namespace hermite::server
