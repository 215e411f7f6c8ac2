#include "server/scan/live_mesher.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/step_back.h"
#include "core/output/mesh_chunk.h"
#include "core/pipeline/pipeline.h"
#include "proto/wire/server_message.h"

namespace hermite::server {

namespace {

// The most waiting changes: more than twice the allowed number of surfels means that the map is too
// large.
constexpr std::size_t kMostWaitingChanges = 2 * mesh::kMostLiveSurfels;
// How often the thread looks for cubes whose pause (kCubeRest) has ended, which no event reports.
constexpr std::chrono::milliseconds kLongestSleep(200);

// Surfels need several observations to be stable. Taking changes costs the worker at most a
// twenty-fifth of its time.
constexpr std::chrono::milliseconds kLeastFeedPeriod(150), kMostFeedPeriod(kMsPerUpdate);
constexpr int kFeedShare = 25;

// The point of interest is this far in front of the camera, a typical distance to surfaces of a
// room.
constexpr double kLooksAt_m = 1.5;

}  // namespace

struct LiveMesher::Impl {
  const std::function<void(MeshUpdate)> tell;
  const std::size_t most_surfels;
  std::mutex mutex;
  std::condition_variable changed;
  Model waiting;            // guarded by mutex, like the next three
  bool is_waiting = false;  // `waiting` holds changes
  bool is_paused = false;
  bool is_ending = false;
  std::optional<mesh::LiveSurface> surface;  // like all below used by the thread only
  Eigen::Vector3f eye_m = Eigen::Vector3f::Zero();
  std::vector<output::SlotChange> first_changes;  // until there are enough to choose the cell size
  std::uint64_t version = 0;
  std::thread thread;

  Impl(std::function<void(MeshUpdate)> teller, std::size_t most)
      : tell(std::move(teller)), most_surfels(most) {}

  void run() {
    step_back();
    bool may_rest = false;
    for (;;) {
      std::optional<Model> model;
      {
        std::unique_lock lock(mutex);
        const auto is_awake = [this] { return is_ending || is_waiting; };
        if (may_rest || is_paused) changed.wait_for(lock, kLongestSleep, is_awake);
        if (is_ending) return;
        if (std::exchange(is_waiting, false)) model = std::exchange(waiting, {});
        may_rest = is_paused;
      }
      if (model && !take(*std::move(model))) return end();
      if (!may_rest) may_rest = !contour_one();
    }
  }

  // Returns false when the map is too large.
  bool take(Model model) {
    if (model.changes.size() > kMostWaitingChanges) return false;
    eye_m = model.eye_m;
    if (!surface) {
      std::move(model.changes.begin(), model.changes.end(), std::back_inserter(first_changes));
      const std::optional<double> cell_m = mesh::live_cell_m(first_changes);
      if (!cell_m) return first_changes.size() <= kMostWaitingChanges;
      surface.emplace(*cell_m, most_surfels);
      model.changes = std::exchange(first_changes, {});
    }
    surface->place(model.submaps, model.since);
    surface->apply(model.changes, model.since);
    return !surface->is_full();
  }

  // Returns false when no cube is due.
  bool contour_one() {
    const Clock::time_point start = Clock::now();
    const std::optional<mesh::SurfaceCube> cube =
        surface ? surface->next(eye_m, start) : std::nullopt;
    if (!cube) return false;
    const std::optional<mesh::CubeMesh> mesh = surface->contour(*cube, start);
    if (!mesh) return true;
    const Result<output::EncodedMesh> encoded =
        output::encode_mesh_chunk(mesh->mesh, surface->cell_m());
    if (!encoded.ok()) {
      spdlog::warn("a piece of a live surface is left out: {}", encoded.error().message);
      return true;
    }
    MeshUpdate update;
    update.pieces.push_back(piece(*cube, mesh->submap, *encoded));
    const Clock::time_point now = Clock::now();
    update.work = {"mesh", start, std::chrono::duration<double, std::milli>(now - start).count()};
    update.delay = now - mesh->since;
    tell(std::move(update));
    return true;
  }

  MeshPiece piece(const mesh::SurfaceCube& cube, std::uint32_t submap,
                  const output::EncodedMesh& mesh) {
    wire::MeshChunk message{
        {cube.part, cube.x, cube.y, cube.z}, ++version, submap, mesh.triangle_count, mesh.draco};
    return {cube, mesh.triangle_count == 0,
            std::make_shared<const std::string>(wire::format_server_message(std::move(message)))};
  }

  void end() {
    MeshUpdate last;
    last.ended = true;
    if (surface)
      for (const mesh::SurfaceCube& cube : surface->shown())
        last.pieces.push_back(piece(cube, 0, {}));
    surface.reset();
    first_changes = {};
    tell(std::move(last));
    std::unique_lock lock(mutex);
    while (!is_ending) {
      changed.wait(lock, [this] { return is_ending || is_waiting; });
      is_waiting = false;
      waiting = {};
    }
  }
};

LiveMesher::LiveMesher(std::function<void(MeshUpdate)> tell, std::size_t most_surfels)
    : impl_(std::make_unique<Impl>(std::move(tell), most_surfels)) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

LiveMesher::~LiveMesher() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_ending = true;
  }
  impl_->changed.notify_one();
  impl_->thread.join();
}

void LiveMesher::add(Model model) {
  {
    const std::lock_guard lock(impl_->mutex);
    Model& waiting = impl_->waiting;
    if (std::exchange(impl_->is_waiting, true)) {
      model.since = waiting.since;
      std::move(model.changes.begin(), model.changes.end(), std::back_inserter(waiting.changes));
      model.changes = std::move(waiting.changes);
    }
    waiting = std::move(model);
  }
  impl_->changed.notify_one();
}

void LiveMesher::pause(bool paused) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_paused = paused;
  }
  impl_->changed.notify_one();
}

void MeshFeed::frame_taken(LiveMesher::Clock::time_point arrived) {
  if (!since_) since_ = arrived;
}

bool MeshFeed::is_due(bool wanted, LiveMesher::Clock::time_point now) const {
  const auto period = std::clamp<LiveMesher::Clock::duration>(kFeedShare * cost_, kLeastFeedPeriod,
                                                              kMostFeedPeriod);
  return wanted && since_ && now - taken_at_ >= period;
}

Result<std::vector<output::SlotChange>> MeshFeed::take_changes(pipeline::Pipeline& pipeline,
                                                               bool wanted) {
  const LiveMesher::Clock::time_point start = LiveMesher::Clock::now();
  Result<std::vector<output::SlotChange>> changes = pipeline.take_changes();
  if (!changes.ok()) return changes;
  if (mesher_) mesher_->pause(!wanted);
  if (!mesher_ && wanted) {
    mesher_ = std::make_unique<LiveMesher>(tell_);
    pipeline.forget_taken_changes();
    Result<std::vector<output::SlotChange>> all = pipeline.take_changes();
    if (!all.ok()) return all;
    std::move(all->begin(), all->end(), std::back_inserter(*changes));
  }
  if (mesher_) {
    LiveMesher::Model model{*changes, {}, Eigen::Vector3f::Zero(), since_.value_or(start)};
    for (const pipeline::SubmapPose& pose : pipeline.submap_poses())
      model.submaps.push_back({pose.world_from_submap, pose.component});
    if (!pipeline.trajectory().empty()) {
      const Rigid3& world_from_camera = pipeline.trajectory().back().world_from_camera;
      model.eye_m = (world_from_camera * Eigen::Vector3d(0, 0, kLooksAt_m)).cast<float>();
    }
    mesher_->add(std::move(model));
  }
  since_.reset();
  taken_at_ = LiveMesher::Clock::now();
  cost_ = taken_at_ - start;
  return changes;
}

}  // namespace hermite::server
