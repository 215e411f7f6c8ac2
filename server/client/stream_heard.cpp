// The part of StreamSession that handles messages of the server.
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <variant>

#include "proto/wire/server_message.h"
#include "server/client/stream_session.h"

namespace hermite {

namespace {

using Clock = std::chrono::steady_clock;

Error error_from(const wire::ErrorMessage& said) {
  ErrorCode code = ErrorCode::kIo;
  for (int value = 0; value <= static_cast<int>(ErrorCode::kBusy); ++value) {
    if (said.code == name_of(static_cast<ErrorCode>(value))) code = static_cast<ErrorCode>(value);
  }
  return {code, "the server says: " + said.message + " (" + said.code + ")"};
}

}  // namespace

Status StreamSession::handle(const std::string& bytes) {
  const auto message = wire::parse_server_message(bytes);
  if (!message.ok()) return in_context("a message of the server", message.error());
  if (!std::holds_alternative<wire::Pong>(*message)) last_news_ = Clock::now();
  std::visit([this](const auto& body) { receive(body); }, *message);
  return Done{};
}

void StreamSession::receive(const wire::Welcome& welcome) {
  if (welcome_) return;
  welcome_ = welcome;
  welcomed_at_ = Clock::now();
  progress_.scan_id = welcome.scan_id;
  credit_.grant_in_all(welcome.frame_credit);
}

void StreamSession::receive(const wire::Credit& credit) {
  credit_.grant_in_all(credit.frames_granted);
  frames_.durable(credit.durable_frames);
  progress_.durable_frames = std::max(progress_.durable_frames, credit.durable_frames);
}

void StreamSession::receive(const wire::FrameResult& result) {
  if (result.sequence < next_result_) return;
  next_result_ = result.sequence + 1;
  ++progress_.processed_frames;
  if (result.status != wire::TrackingStatus::kLost) ++progress_.tracked_frames;
  progress_.last_result = result;
  if (result.event != wire::MapEvent::kNone && observer_.on_event) observer_.on_event(result);
}

void StreamSession::receive(const wire::ScanState& state) {
  progress_.server_dropped_frames = state.frames_dropped;
  // Results that were sent while there was no connection are not sent again.
  progress_.processed_frames = std::max(progress_.processed_frames, state.frames_processed);
  if (state.phase == wire::ScanPhase::kFinished) progress_.last_message = state.message;
  if (state.phase == wire::ScanPhase::kFailed || state.phase == wire::ScanPhase::kInterrupted) {
    if (!failure_) failure_ = Error{ErrorCode::kIo, "the scan failed on the server: " + state.message};
  }
}

void StreamSession::receive(const wire::NotResumed& refused) {
  failure_ = Error{ErrorCode::kIo, "the server does not go on with scan " + progress_.scan_id + ": " + refused.reason};
}

void StreamSession::receive(const wire::GoAway& away) {
  constexpr std::uint32_t kLongest_ms = 60'000;  // limit, since a user is waiting
  stay_away_ = std::chrono::milliseconds(std::min(away.resume_after_ms, kLongest_ms));
}

void StreamSession::receive(const wire::Waiting& waiting) {
  // Reported when it changes, for users who wait.
  if (!waiting_ || waiting_->before != waiting.before || (waiting_->expected_s == 0 && waiting.expected_s > 0))
    tell_link("no place on the server yet, waiting" + (waiting.before > 0 ? " behind " + std::to_string(waiting.before) + " others" : "") +
              (waiting.expected_s > 0 ? ", about " + std::to_string(waiting.expected_s) + " s" : ""));
  waiting_ = waiting;
  hello_deadline_ = Clock::now() + request_.connect_patience;
}

void StreamSession::receive(const wire::PauseRequest& request) {
  if (observer_.on_pause_request) return observer_.on_pause_request(request.paused);
  if (held_ != request.paused) tell_link(request.paused ? kPausedByViewer : kUnpausedByViewer);
  held_ = request.paused;
}

void StreamSession::receive(const wire::ErrorMessage& error) {
  if (!error.about_frame) {
    failure_ = error_from(error);
    return;
  }
  tell_problem("frame number " + std::to_string(error.sequence) + ": " + error_from(error).message);
}

}  // namespace hermite
