#include "server/service/audience.h"

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

void Audience::show_result(const wire::FrameResult& result) {
  const Eigen::Vector3f position_m = result.world_from_camera.translation.cast<float>();
  positions_m_.insert(positions_m_.end(), position_m.data(), position_m.data() + 3);
  result_ = shared(result);
  for (Viewer* viewer : viewers_) viewer->result_ = result_;
  wake_all();
}

void Audience::show_model(ModelUpdate update) {
  poses_ = shared(std::move(update.poses));
  for (ChunkUpdate& chunk : update.chunks) chunks_[chunk.key] = {std::move(chunk.message), chunk.empty};
  for (Viewer* viewer : viewers_) {
    viewer->poses_ = poses_;
    for (const ChunkUpdate& chunk : update.chunks) viewer->dirty_.insert(chunk.key);
  }
  wake_all();
}

void Audience::add_positions(const std::vector<float>& positions_m) {
  positions_m_.insert(positions_m_.end(), positions_m.begin(), positions_m.end());
}

void Audience::close() {
  closed_ = true;
  wake_all();
}

Result<std::unique_ptr<Viewer>> Audience::join(const std::shared_ptr<Audience>& audience, std::function<void()> wake) {
  if (audience->viewers_.size() >= static_cast<std::size_t>(kMaxViewersPerScan))
    return Error{ErrorCode::kBusy, "the scan has " + std::to_string(kMaxViewersPerScan) + " viewers, which is the limit"};
  return std::make_unique<Viewer>(audience, std::move(wake));
}

Viewer::Viewer(std::shared_ptr<Audience> audience, std::function<void()> wake)
    : audience_(std::move(audience)),
      wake_(std::move(wake)),
      state_(audience_->state_),
      poses_(audience_->poses_),
      result_(audience_->result_) {
  if (!audience_->positions_m_.empty()) trajectory_ = shared(wire::TrajectoryPart{audience_->positions_m_});
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
  for (SharedBytes* newest : {&state_, &trajectory_, &poses_, &result_})
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
  return audience_->closed_ && snapshot_ended_ && dirty_.empty() && !state_ && !poses_ && !result_ && !trajectory_;
}

}  // namespace hermite
