#include "server/scan/subscribers.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "proto/wire/server_message.h"

namespace hermite::server {

namespace {

SharedBytes shared_bytes(wire::ServerMessage message) {
  return std::make_shared<const std::string>(wire::format_server_message(std::move(message)));
}

}  // namespace

void Subscribers::wake_all() {
  for (Viewer* viewer : viewers_) viewer->wake_();
}

void Subscribers::show_state(const wire::ScanState& state) {
  state_ = shared_bytes(state);
  for (Viewer* viewer : viewers_) viewer->state_ = state_;
  wake_all();
}

void Subscribers::add_position(const wire::PoseInSubmap& where) {
  const Eigen::Vector3f position_m = where.submap_from_camera.translation.cast<float>();
  positions_in_submaps_m_.insert(positions_in_submaps_m_.end(), position_m.data(),
                                 position_m.data() + 3);
  submaps_.push_back(where.submap);
}

void Subscribers::show_past(const std::vector<wire::PoseInSubmap>& poses) {
  for (const wire::PoseInSubmap& pose : poses) add_position(pose);
  // Viewers that are already connected have no past positions, or other ones.
  for (Viewer* viewer : viewers_) viewer->trajectory_ = shared_bytes(trajectory());
  wake_all();
}

void Subscribers::show_other_past(const std::vector<wire::PoseInSubmap>& poses) {
  positions_in_submaps_m_.clear();
  submaps_.clear();
  show_past(poses);
}

void Subscribers::show_result(const wire::FrameResult& result) {
  add_position(result.in_submap.value_or(wire::PoseInSubmap{0, result.world_from_camera}));
  result_ = shared_bytes(result);
  const bool has_event = result.event != wire::MapEvent::kNone;
  for (Viewer* viewer : viewers_) {
    viewer->result_ = has_event ? nullptr : result_;
    if (has_event) viewer->event_ = result_;
  }
  wake_all();
}

void Subscribers::show_poses(wire::SubmapPoses poses) {
  for (const wire::SubmapPose& pose : poses.poses)
    world_from_submap_[pose.submap] = pose.world_from_submap;
  poses_ = shared_bytes(std::move(poses));
  for (Viewer* viewer : viewers_) viewer->poses_ = poses_;
  wake_all();
}

void Subscribers::show_model(ModelUpdate update) {
  show_poses(std::move(update.poses));
  for (ChunkUpdate& chunk : update.chunks)
    chunks_[chunk.key] = {std::move(chunk.message), chunk.empty};
  for (Viewer* viewer : viewers_) {
    for (const ChunkUpdate& chunk : update.chunks) viewer->chunks_.add(chunk.key);
  }
  wake_all();
}

void Subscribers::show_mesh(MeshUpdate update) {
  for (MeshPiece& piece : update.pieces) {
    pieces_[piece.cube] = {std::move(piece.message), piece.empty};
    for (Viewer* viewer : viewers_) viewer->pieces_.add(piece.cube);
  }
  mesh_ended_ = mesh_ended_ || update.ended;
  wake_all();
}

void Subscribers::tell_mesh_wanted(std::function<void(bool)> tell) {
  tell_mesh_wanted_ = std::move(tell);
  if (tell_mesh_wanted_) tell_mesh_wanted_(mesh_wanted_);
}

void Subscribers::ask_for_mesh() {
  const bool wanted = std::any_of(viewers_.begin(), viewers_.end(),
                                  [](const Viewer* viewer) { return viewer->sees_mesh(); });
  if (std::exchange(mesh_wanted_, wanted) != wanted && tell_mesh_wanted_) tell_mesh_wanted_(wanted);
}

wire::TrajectoryPart Subscribers::trajectory() const {
  if (submaps_.empty()) return {final_positions_m_, {}, {}};
  wire::TrajectoryPart part{{}, positions_in_submaps_m_, submaps_};
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    const auto pose = world_from_submap_.find(submaps_[i]);
    const Eigen::Vector3d position_m =
        Eigen::Map<const Eigen::Vector3f>(&positions_in_submaps_m_[3 * i]).cast<double>();
    const Eigen::Vector3d world_m =
        pose == world_from_submap_.end() ? position_m : pose->second * position_m;
    for (const double axis : world_m) part.positions_m.push_back(static_cast<float>(axis));
  }
  return part;
}

void Subscribers::close() {
  closed_ = true;
  wake_all();
}

Result<std::unique_ptr<Viewer>> Subscribers::join(const std::shared_ptr<Subscribers>& subscribers,
                                                  const ViewerToken& token,
                                                  const wire::Watch& watch,
                                                  std::function<void()> wake) {
  const std::set<Viewer*>& viewers = subscribers->viewers_;
  const auto own = std::count_if(viewers.begin(), viewers.end(), [&token](const Viewer* viewer) {
    return viewer->token_id_ == token.token_id;
  });
  const Taken taken{static_cast<std::int64_t>(viewers.size()), own};
  if (Status status = check_share(kViewerShare, taken, token.is_admin, "viewers of a scan");
      !status.ok())
    return status.error();
  return std::make_unique<Viewer>(subscribers, token.token_id, watch, std::move(wake));
}

Viewer::Viewer(std::shared_ptr<Subscribers> subscribers, std::string token_id,
               const wire::Watch& watch, std::function<void()> wake)
    : subscribers_(std::move(subscribers)),
      token_id_(std::move(token_id)),
      wake_(std::move(wake)),
      state_(subscribers_->state_),
      poses_(subscribers_->poses_),
      result_(subscribers_->result_),
      watch_(watch),
      chunks_(subscribers_->chunks_),
      pieces_(subscribers_->pieces_) {
  if (wire::TrajectoryPart past = subscribers_->trajectory(); !past.positions_m.empty())
    trajectory_ = shared_bytes(std::move(past));
  subscribers_->viewers_.insert(this);
  subscribers_->ask_for_mesh();
}

Viewer::~Viewer() {
  subscribers_->viewers_.erase(this);
  subscribers_->ask_for_mesh();
}

void Viewer::watch(const wire::Watch& watch) {
  watch_ = watch;
  subscribers_->ask_for_mesh();
}

// The surface of an ended scan is an export; until a viewer has loaded that it shows points.
bool Viewer::sees_points() const {
  return watch_.points || subscribers_->closed_ || subscribers_->mesh_ended_;
}

SharedBytes Viewer::counted(SharedBytes message) {
  if (message) sent_bytes_ += message->size();
  return message;
}

SharedBytes Viewer::next() {
  for (SharedBytes* newest : {&state_, &trajectory_, &poses_, &event_, &result_})
    if (*newest) return counted(std::exchange(*newest, nullptr));
  const bool has_snapshot =
      (!sees_points() || chunks_.has_snapshot()) && (!sees_mesh() || pieces_.has_snapshot());
  if (!snapshot_ended_ && has_snapshot) {
    snapshot_ended_ = true;
    return counted(shared_bytes(wire::SnapshotEnd{}));
  }
  if (sees_mesh())
    if (SharedBytes piece = next_part(subscribers_->pieces_, pieces_)) return piece;
  return sees_points() ? next_part(subscribers_->chunks_, chunks_) : nullptr;
}

template <class Key>
SharedBytes Viewer::next_part(const std::map<Key, ShownPart>& parts, MissingParts<Key>& missing) {
  if (missing.empty()) return nullptr;
  const Key key = missing.next();
  const SharedBytes& message = parts.at(key).message;
  const std::uint64_t unacked_bytes = sent_bytes_ - acknowledged_bytes_;
  if (unacked_bytes > 0 && unacked_bytes + message->size() > kMaxUnackedBytes) return nullptr;
  missing.sent(key);
  return counted(message);
}

Status Viewer::acknowledge(std::uint64_t bytes) {
  if (bytes > sent_bytes_)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("viewer_ack.bytes is {}, sent were only {}", bytes, sent_bytes_)};
  if (bytes > acknowledged_bytes_) acknowledged_bytes_ = bytes;
  return Done{};
}

bool Viewer::complete() const {
  const bool has_parts = chunks_.empty() && (!sees_mesh() || pieces_.empty());
  return subscribers_->closed_ && snapshot_ended_ && has_parts && !state_ && !poses_ && !event_ &&
         !result_ && !trajectory_;
}

}  // namespace hermite::server
