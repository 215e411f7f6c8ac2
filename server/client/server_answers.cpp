#include "server/client/server_answers.h"

#include <fmt/core.h>

#include <algorithm>
#include <type_traits>
#include <utility>
#include <variant>

#include "proto/wire/server_message.h"

namespace hermite::client {

namespace {

Error error_from(const wire::ErrorMessage& said) {
  ErrorCode code = ErrorCode::kIo;
  for (int value = 0; value <= static_cast<int>(ErrorCode::kBusy); ++value) {
    if (said.code == name_of(static_cast<ErrorCode>(value))) code = static_cast<ErrorCode>(value);
  }
  return {code, fmt::format("the server says: {} ({})", said.message, said.code)};
}

// For viewers or from a newer server: a camera ignores them.
template <class Message>
concept ForOthers = std::is_same_v<Message, wire::Chunk> ||
    std::is_same_v<Message, wire::MeshChunk> || std::is_same_v<Message, wire::SnapshotEnd> ||
    std::is_same_v<Message, wire::TrajectoryPart> || std::is_same_v<Message, wire::Unknown>;

}  // namespace

// One overload per message type of the protocol.
struct ServerAnswers::Reader {
  ServerAnswers& answers;
  StreamReport& report;
  SteadyTime now;

  void operator()(const wire::Welcome& welcome) {
    if (answers.welcome_) return;
    answers.welcome_ = welcome;
    answers.welcomed_at_ = now;
    report.progress.scan_id = welcome.scan_id;
  }

  void operator()(const wire::Credit& credit) { answers.concerned_.frames.granted(credit); }

  void operator()(const wire::FrameResult& result) {
    if (result.sequence < answers.next_result_) return;
    answers.next_result_ = result.sequence + 1;
    ++report.progress.processed_frames;
    if (result.status != wire::TrackingStatus::kLost) ++report.progress.tracked_frames;
    report.progress.last_result = result;
    if (result.event != wire::MapEvent::kNone && report.observer.on_event)
      report.observer.on_event(result);
  }

  void operator()(const wire::ScanState& state) {
    report.progress.server_dropped_frames = state.frames_dropped;
    // Results that were sent while there was no connection are not sent again.
    report.progress.processed_frames =
        std::max(report.progress.processed_frames, state.frames_processed);
    if (state.phase == wire::ScanPhase::kFinished) report.progress.last_message = state.message;
    if (state.phase == wire::ScanPhase::kFailed || state.phase == wire::ScanPhase::kInterrupted) {
      if (!answers.failure_)
        answers.failure_ = Error{ErrorCode::kIo, "the scan failed on the server: " + state.message};
    }
  }

  void operator()(const wire::Finished& finished) { answers.finished_ = finished; }
  void operator()(const wire::Pong& pong) { answers.concerned_.link.answered(pong); }
  void operator()(const wire::Resumed& resumed) { answers.resumed_ = resumed; }

  void operator()(const wire::NotResumed& refused) {
    answers.failure_ =
        Error{ErrorCode::kIo, fmt::format("the server does not go on with scan {}: {}",
                                          report.progress.scan_id, refused.reason)};
  }

  void operator()(const wire::GoAway& away) {
    constexpr std::uint32_t kLongest_ms = 60'000;  // limit, since a user is waiting
    answers.stay_away_ = std::chrono::milliseconds(std::min(away.resume_after_ms, kLongest_ms));
  }

  void operator()(const wire::Waiting& waiting) {
    const std::optional<wire::Waiting>& before = answers.waiting_;
    // Reported when it changes, for users who wait.
    if (!before || before->before != waiting.before ||
        (before->expected_s == 0 && waiting.expected_s > 0))
      report.tell_link(fmt::format(
          "no place on the server yet, waiting{}{}",
          waiting.before > 0 ? fmt::format(" behind {} others", waiting.before) : "",
          waiting.expected_s > 0 ? fmt::format(", about {} s", waiting.expected_s) : ""));
    answers.waiting_ = waiting;
    answers.waiting_said_at_ = now;
  }

  void operator()(const wire::PauseRequest& request) {
    if (report.observer.on_pause_request) return report.observer.on_pause_request(request.paused);
    if (answers.holds_frames_ != request.paused)
      report.tell_link(request.paused ? kPausedByViewer : kUnpausedByViewer);
    answers.holds_frames_ = request.paused;
  }

  void operator()(const wire::ErrorMessage& error) {
    if (!error.about_frame) {
      answers.failure_ = error_from(error);
      return;
    }
    report.tell_problem(
        fmt::format("frame number {}: {}", error.sequence, error_from(error).message));
  }

  void operator()(const wire::SubmapPoses&) {}
  template <ForOthers Message>
  void operator()(const Message&) {
    ++report.progress.unknown_messages;
  }
};

Status ServerAnswers::take(const std::string& bytes, SteadyTime now) {
  const auto message = wire::parse_server_message(bytes);
  if (!message.ok()) return in_context("a message of the server", message.error());
  if (!std::holds_alternative<wire::Pong>(*message)) last_news_ = now;
  std::visit(Reader{*this, concerned_.report, now}, *message);
  return Done{};
}

void ServerAnswers::connected(SteadyTime now) {
  resumed_.reset();
  waiting_.reset();
  last_news_ = now;
}

std::chrono::milliseconds ServerAnswers::take_stay_away() {
  return std::exchange(stay_away_, std::nullopt).value_or(std::chrono::milliseconds(0));
}

}  // namespace hermite::client
