// What viewers of one scan see, and who they are. Every viewer has a set of chunks it does not have yet instead of a queue: one that is
// slow skips versions, one that joins late starts with every chunk in the set, and memory is bounded by the model's size. What a viewer
// does not want to see stays in its set, so that it gets what it lacks when it changes its mind.
//
// Messages are formatted once and shared. All of it belongs to the network thread.
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

namespace hermite {

// Of one scan. A share link is one token, however many open it: half of all places are for one link.
inline constexpr Share kViewerShare{32, 16, 4};
inline constexpr std::uint64_t kMaxUnackedBytes = 4 * 1024 * 1024;

struct SceneInfo {
  std::string scan_id;
  std::string title;
  Camera camera;
};

// With what a viewer came in.
struct ViewerToken {
  std::string token_id;
  bool is_admin = false;
};

// A message ready to be sent, of the newest version of a chunk of points or of a piece of the surface.
struct ShownPart {
  SharedBytes message;
  bool empty = false;
};

// Of one kind of parts, what a viewer does not have yet.
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
  bool has_snapshot() const { return snapshot_.empty(); }  // all that there was when the viewer came is sent

  // Round and round rather than always from the front: parts that change all the time must not keep the others back. Not empty.
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

class Audience {
 public:
  explicit Audience(SceneInfo info) : info_(std::move(info)) {}
  Audience(const Audience&) = delete;
  Audience& operator=(const Audience&) = delete;

  const SceneInfo& info() const { return info_; }
  void rename(const std::string& title) { info_.title = title; }  // for those who come from now on

  void show_state(const wire::ScanState& state);
  void show_result(const wire::FrameResult& result);                   // and adds its position to the trajectory
  void show_past(const std::vector<wire::PoseInSubmap>& poses);        // of frames whose results nobody told: they come before all others
  void show_other_past(const std::vector<wire::PoseInSubmap>& poses);  // instead of all positions so far: the map was made anew
  void show_poses(wire::SubmapPoses poses);
  void show_model(ModelUpdate update);
  void show_mesh(MeshUpdate update);  // when it has ended, all see points

  // Told at once and whenever it changes whether anybody wants to see a surface; nullptr: nobody wants to know.
  void tell_mesh_wanted(std::function<void(bool)> tell);

  // Of a scan that is over: in the world, where nothing moves any more.
  void set_positions(std::vector<float> positions_m) { final_positions_m_ = std::move(positions_m); }

  // The scan has ended and its last state and model were shown: viewers may leave once they have everything.
  void close();

  std::size_t viewer_count() const { return viewers_.size(); }

  // `wake` is called when the viewer may have something to send. kBusy: the share of the token is used up.
  static Result<std::unique_ptr<Viewer>> join(const std::shared_ptr<Audience>& audience, const ViewerToken& token, const wire::Watch& watch,
                                              std::function<void()> wake);

 private:
  friend class Viewer;
  void wake_all();
  void ask_for_mesh();
  void add_position(const wire::PoseInSubmap& where);
  wire::TrajectoryPart trajectory() const;

  SceneInfo info_;
  SharedBytes state_, poses_, result_;
  std::map<ChunkKey, ShownPart> chunks_;
  std::map<SurfaceCube, ShownPart> pieces_;  // of the surface
  bool mesh_ended_ = false;
  bool mesh_wanted_ = false;
  std::function<void(bool)> tell_mesh_wanted_;
  // Of every result, in the frame of its submap: what is corrected later moves with it.
  std::vector<float> positions_in_submaps_m_;  // x y z
  std::vector<std::uint32_t> submaps_;
  std::map<std::uint32_t, Rigid3> world_from_submap_;
  std::vector<float> final_positions_m_;  // x y z
  bool closed_ = false;
  std::set<Viewer*> viewers_;
};

// One viewer's share of an audience: what to send next. The audience outlives it.
class Viewer {
 public:
  Viewer(std::shared_ptr<Audience> audience, std::string token_id, const wire::Watch& watch, std::function<void()> wake);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // The next message, to be called when the socket is free; none when there is nothing, or when more than kMaxUnackedBytes are under way.
  SharedBytes next();

  // What it wants to see from now on, while the scan runs.
  void watch(const wire::Watch& watch);

  // kInvalidArgument: more than was sent.
  Status acknowledge(std::uint64_t bytes);

  // The scan has ended and all of it was sent.
  bool complete() const;

  // Bytes of a message that reached the viewer another way (Welcome, Pong): they count, since the viewer counts them.
  void count_sent(std::size_t bytes) { sent_bytes_ += bytes; }

 private:
  friend class Audience;
  bool sees_points() const;
  bool sees_mesh() const { return watch_.mesh; }
  template <class Key>
  SharedBytes next_part(const std::map<Key, ShownPart>& parts, MissingParts<Key>& missing);
  SharedBytes counted(SharedBytes message);

  const std::shared_ptr<Audience> audience_;
  const std::string token_id_;
  const std::function<void()> wake_;
  SharedBytes state_, poses_, result_, trajectory_;  // newest not yet sent
  SharedBytes event_;                                // the newest result with an event, sent although there is a newer one without
  wire::Watch watch_;
  MissingParts<ChunkKey> chunks_;
  MissingParts<SurfaceCube> pieces_;
  bool snapshot_ended_ = false;
  std::uint64_t sent_bytes_ = 0, acknowledged_bytes_ = 0;
};

}  // namespace hermite
