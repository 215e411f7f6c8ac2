#include "server/service/audience.h"

#include <algorithm>
#include <utility>

#include "proto/wire/server_message.h"

namespace hermite {

namespace {

SharedBytes shared(wire::ServerMessage message) {
  return std::make_shared<const std::string>(wire::format_server_message(std::move(message)));
}

}  // namespace

void Audience::wake_all() {
  for (Viewer* viewer : viewers_) viewer->wake_();
}

void Audience::show_state(const wire::ScanState& state) {
  state_ = shared(state);
  for (Viewer* viewer : viewers_) viewer->state_ = state_;
  wake_all();
}

void Audience::add_position(const wire::PoseInSubmap& where) {
  const Eigen::Vector3f position_m = where.submap_from_camera.translation.cast<float>();
  positions_in_submaps_m_.insert(positions_in_submaps_m_.end(), position_m.data(), position_m.data() + 3);
  submaps_.push_back(where.submap);
}

void Audience::show_past(const std::vector<wire::PoseInSubmap>& poses) {
  for (const wire::PoseInSubmap& pose : poses) add_position(pose);
  // Who is there already has been told of no past, or of another one.
  for (Viewer* viewer : viewers_) viewer->trajectory_ = shared(trajectory());
  wake_all();
}

void Audience::show_other_past(const std::vector<wire::PoseInSubmap>& poses) {
  positions_in_submaps_m_.clear();
  submaps_.clear();
  show_past(poses);
}

void Audience::show_result(const wire::FrameResult& result) {
  add_position(result.in_submap.value_or(wire::PoseInSubmap{0, result.world_from_camera}));
  result_ = shared(result);
  const bool has_event = result.event != wire::MapEvent::kNone;
  for (Viewer* viewer : viewers_) {
    viewer->result_ = has_event ? nullptr : result_;
    if (has_event) viewer->event_ = result_;
  }
  wake_all();
}

void Audience::show_poses(wire::SubmapPoses poses) {
  for (const wire::SubmapPose& pose : poses.poses) world_from_submap_[pose.submap] = pose.world_from_submap;
  poses_ = shared(std::move(poses));
  for (Viewer* viewer : viewers_) viewer->poses_ = poses_;
  wake_all();
}

void Audience::show_model(ModelUpdate update) {
  show_poses(std::move(update.poses));
  for (ChunkUpdate& chunk : update.chunks) chunks_[chunk.key] = {std::move(chunk.message), chunk.empty};
  for (Viewer* viewer : viewers_) {
    for (const ChunkUpdate& chunk : update.chunks) viewer->dirty_.insert(chunk.key);
  }
  wake_all();
}

wire::TrajectoryPart Audience::trajectory() const {
  if (submaps_.empty()) return {final_positions_m_, {}, {}};
  wire::TrajectoryPart part{{}, positions_in_submaps_m_, submaps_};
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    const auto pose = world_from_submap_.find(submaps_[i]);
    const Eigen::Vector3d position_m = Eigen::Map<const Eigen::Vector3f>(&positions_in_submaps_m_[3 * i]).cast<double>();
    const Eigen::Vector3d world_m = pose == world_from_submap_.end() ? position_m : pose->second * position_m;
    for (const double axis : world_m) part.positions_m.push_back(static_cast<float>(axis));
  }
  return part;
}

void Audience::close() {
  closed_ = true;
  wake_all();
}

Result<std::unique_ptr<Viewer>> Audience::join(const std::shared_ptr<Audience>& audience, const ViewerToken& token,
                                               std::function<void()> wake) {
  const std::set<Viewer*>& viewers = audience->viewers_;
  const auto own =
      std::count_if(viewers.begin(), viewers.end(), [&token](const Viewer* viewer) { return viewer->token_id_ == token.token_id; });
  const Taken taken{static_cast<std::int64_t>(viewers.size()), own};
  if (Status status = check_share(kViewerShare, taken, token.is_admin, "viewers of a scan"); !status.ok()) return status.error();
  return std::make_unique<Viewer>(audience, token.token_id, std::move(wake));
}

Viewer::Viewer(std::shared_ptr<Audience> audience, std::string token_id, std::function<void()> wake)
    : audience_(std::move(audience)),
      token_id_(std::move(token_id)),
      wake_(std::move(wake)),
      state_(audience_->state_),
      poses_(audience_->poses_),
      result_(audience_->result_) {
  if (wire::TrajectoryPart past = audience_->trajectory(); !past.positions_m.empty()) trajectory_ = shared(std::move(past));
  for (const auto& [key, chunk] : audience_->chunks_)
    if (!chunk.empty) dirty_.insert(key);
  snapshot_ = dirty_;
  audience_->viewers_.insert(this);
}

Viewer::~Viewer() { audience_->viewers_.erase(this); }

SharedBytes Viewer::counted(SharedBytes message) {
  if (message) sent_bytes_ += message->size();
  return message;
}

SharedBytes Viewer::next() {
  for (SharedBytes* newest : {&state_, &trajectory_, &poses_, &event_, &result_})
    if (*newest) return counted(std::exchange(*newest, nullptr));
  if (!snapshot_ended_ && snapshot_.empty()) {
    snapshot_ended_ = true;
    return counted(shared(wire::SnapshotEnd{}));
  }
  return next_chunk();
}

SharedBytes Viewer::next_chunk() {
  if (dirty_.empty()) return nullptr;
  // Round and round rather than always from the front: chunks that change all the time must not keep the others back.
  auto chosen = last_sent_ ? dirty_.upper_bound(*last_sent_) : dirty_.begin();
  if (chosen == dirty_.end()) chosen = dirty_.begin();
  const ChunkKey key = *chosen;
  const SharedBytes& message = audience_->chunks_.at(key).message;
  const std::uint64_t unacked_bytes = sent_bytes_ - acknowledged_bytes_;
  if (unacked_bytes > 0 && unacked_bytes + message->size() > kMaxUnackedBytes) return nullptr;
  dirty_.erase(chosen);
  snapshot_.erase(key);
  last_sent_ = key;
  return counted(message);
}

Status Viewer::acknowledge(std::uint64_t bytes) {
  if (bytes > sent_bytes_)
    return Error{ErrorCode::kInvalidArgument,
                 "viewer_ack.bytes is " + std::to_string(bytes) + ", sent were only " + std::to_string(sent_bytes_)};
  if (bytes > acknowledged_bytes_) acknowledged_bytes_ = bytes;
  return Done{};
}

bool Viewer::complete() const {
  return audience_->closed_ && snapshot_ended_ && dirty_.empty() && !state_ && !poses_ && !event_ && !result_ && !trajectory_;
}

}  // namespace hermite
