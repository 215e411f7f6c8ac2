#include "server/client/outgoing_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "proto/wire/client_message.h"

namespace hermite::client {

OutgoingFrames::OutgoingFrames(FrameSource& source, const Pacing& pacing, StreamReport& report)
    : source_(source), report_(report), is_live_(pacing.newest_wins), gate_(pacing) {}

void OutgoingFrames::start(const wire::Welcome& welcome, std::function<void()> on_ready) {
  max_message_bytes_ = welcome.max_message_bytes;
  is_resumable_ = !welcome.resume_token.empty();
  credit_.grant_in_all(welcome.frame_credit);
  const auto& accepted = welcome.color_codecs;
  const bool png_color =
      std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kPng) != accepted.end();
  encoder_.emplace(source_, FrameEncoder::Settings{.encoding = {welcome.depth_codec, png_color}},
                   std::move(on_ready));
}

void OutgoingFrames::offer(SteadyTime now, bool held) {
  if (!encoder_) return;
  while (!held && gate_.wants(now)) {
    auto encoded = encoder_->take();
    if (!encoded) break;
    gate_.offer(*std::move(encoded), now);
  }
  report_.progress.dropped_frames = gate_.dropped_count();
  report_.progress.left_out_frames = gate_.left_out_count();
  if (is_live_) adapt_to_link(now);
}

void OutgoingFrames::adapt_to_link(SteadyTime now) {
  if (now < judge_link_at_) return;
  judge_link_at_ = now + std::chrono::seconds(1);
  const LinkCounts counts{gate_.due_count(), gate_.dropped_count()};
  link_state_ =
      after_a_second(link_state_, {counts.due - counted_.due, counts.dropped - counted_.dropped});
  counted_ = counts;
  const LinkLevel level = link_level(link_state_.level);
  encoder_->set_jpeg_quality(level.jpeg_quality);
  gate_.keep(level.kept_frames, level.of_frames);
  report_.progress.link_level = link_state_.level;
}

Status OutgoingFrames::number_next(SteadyTime now) {
  const bool room = !sent_.next() && sent_.kept_count() < kMaxKeptFrames;
  std::optional<EncodedFrame> encoded = gate_.take(now, room);
  if (!encoded) return Done{};
  if (!encoded->problem.empty()) report_.tell_problem(encoded->problem);
  encoded->frame.sequence = sent_.numbered_count();
  std::string message = wire::format_client_message(std::move(encoded->frame));
  if (message.size() > max_message_bytes_) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("frame {} takes {} bytes, the server accepts {}", encoded->index,
                             message.size(), max_message_bytes_)};
  }
  sent_.add(std::move(message));
  return Done{};
}

void OutgoingFrames::sent() {
  sent_.sent();
  credit_.take();
  report_.progress.sent_frames = std::max(report_.progress.sent_frames, sent_.sent_count());
  // A server that does not support resuming never requests a frame again.
  if (!is_resumable_) sent_.durable(sent_.sent_count());
}

void OutgoingFrames::granted(const wire::Credit& credit) {
  credit_.grant_in_all(credit.frames_granted);
  sent_.durable(credit.durable_frames);
  report_.progress.durable_frames =
      std::max(report_.progress.durable_frames, credit.durable_frames);
}

Status OutgoingFrames::resume(const wire::Resumed& resumed) {
  sent_.durable(resumed.durable_frames);
  if (Status status = sent_.resume_at(resumed.next_sequence); !status.ok()) return status;
  credit_ = CreditWindow(resumed.frames_granted, resumed.next_sequence);
  return Done{};
}

}  // namespace hermite::client
