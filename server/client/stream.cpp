#include "server/client/stream.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"
#include "server/client/connection.h"
#include "server/client/depth_codec_choice.h"
#include "server/client/frame_encoder.h"
#include "server/client/link_adaption.h"

namespace hermite {
namespace {

using Clock = std::chrono::steady_clock;

// How long an interrupt or a report of progress may have to wait.
constexpr std::chrono::milliseconds kTick(100);
constexpr std::chrono::milliseconds kClosePatience(2000);

double seconds_between(SteadyTime from, SteadyTime to) { return std::chrono::duration<double>(to - from).count(); }

Error error_from(const wire::ErrorMessage& said) {
  ErrorCode code = ErrorCode::kIo;
  for (int value = 0; value <= static_cast<int>(ErrorCode::kBusy); ++value) {
    if (said.code == name_of(static_cast<ErrorCode>(value))) code = static_cast<ErrorCode>(value);
  }
  return {code, "the server says: " + said.message + " (" + said.code + ")"};
}

// What one scan knows of itself while it runs. Lives on one thread, beside its connection.
class Session {
 public:
  Session(const Sequence& sequence, const StreamRequest& request, const StreamObserver& observer, Connection& connection)
      : sequence_(sequence), request_(request), observer_(observer), connection_(connection) {
    progress_.frame_count = request.frames.count();
  }

  Status greet();
  Status pump();
  Status finish();
  StreamOutcome outcome() const { return {finished_->report_json, finished_->trajectory_tum, progress_}; }

 private:
  Status step(std::optional<SteadyTime> next_event);
  Status handle(const std::string& bytes);
  Status check_welcome() const;
  Status send_frame(EncodedFrame encoded);
  void adapt_to_link(SteadyTime now, FrameEncoder& encoder, FrameGate& gate);
  bool server_has_work() const;
  int interrupts() const { return observer_.interrupt_count ? observer_.interrupt_count() : 0; }
  void tell_problem(const std::string& words);
  void tell_progress();

  // One overload a body of the protocol.
  void receive(const wire::Welcome& welcome);
  void receive(const wire::FrameResult& result);
  void receive(const wire::Credit& credit) { credit_.grant_in_all(credit.frames_granted); }
  void receive(const wire::ScanState& state);
  void receive(const wire::Finished& finished) { finished_ = finished; }
  void receive(const wire::ErrorMessage& error);
  void receive(const wire::Pong&) {}
  void receive(const wire::SubmapPoses&) {}
  void receive(const wire::Unknown&) { ++progress_.unknown_messages; }
  // For viewers; a camera that gets one anyway has no use for it.
  void receive(const wire::Chunk&) { ++progress_.unknown_messages; }
  void receive(const wire::SnapshotEnd&) { ++progress_.unknown_messages; }
  void receive(const wire::TrajectoryPart&) { ++progress_.unknown_messages; }

  const Sequence& sequence_;
  const StreamRequest& request_;
  const StreamObserver& observer_;
  Connection& connection_;

  StreamProgress progress_;
  CreditWindow credit_;
  LinkState link_;
  LinkCounts counted_;        // when the link was judged last
  SteadyTime judge_link_at_;  // live only
  SteadyTime welcomed_at_;
  SteadyTime last_news_ = Clock::now();
  std::optional<wire::Welcome> welcome_;
  std::optional<wire::Finished> finished_;
  std::optional<Error> failure_;  // the server ended the scan
};

Status Session::greet() {
  wire::StartScan start;
  start.title = request_.title;
  start.camera = sequence_.camera();
  start.depth_codecs = depth_codecs_for(sequence_, request_.frames);
  start.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
  start.mode = request_.pacing.newest_wins ? wire::Mode::kLive : wire::Mode::kBatch;
  start.settings = request_.settings;
  start.expected_frames = static_cast<std::uint64_t>(request_.frames.count());
  connection_.send(
      wire::format_client_message(wire::Hello{wire::kProtocolMinor, "hermite-client", request_.server.token, std::move(start)}));

  const SteadyTime deadline = Clock::now() + request_.connect_patience;
  while (!welcome_) {
    if (Status status = step(deadline); !status.ok()) return status;
    if (interrupts() > 0) return Error{ErrorCode::kIo, "interrupted before the scan began"};
    if (!welcome_ && Clock::now() >= deadline) return Error{ErrorCode::kIo, "the server does not answer the hello"};
  }
  return check_welcome();
}

Status Session::check_welcome() const {
  const auto& accepted = welcome_->color_codecs;
  if (std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kJpeg) == accepted.end()) {
    return Error{ErrorCode::kUnsupported, "the server accepts no JPEG colour"};
  }
  return Done{};
}

Status Session::pump() {
  const auto& accepted = welcome_->color_codecs;
  const bool png_color = std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kPng) != accepted.end();
  FrameEncoder encoder(sequence_, {.range = request_.frames, .encoding = {welcome_->depth_codec, png_color}},
                       [this] { connection_.wake(); });
  FrameGate gate(request_.pacing);
  while (interrupts() == 0 && !(encoder.exhausted() && gate.empty())) {
    const SteadyTime now = Clock::now();
    while (gate.wants(now)) {
      auto encoded = encoder.take();
      if (!encoded) break;
      gate.offer(*std::move(encoded), now);
    }
    progress_.dropped_frames = gate.dropped_count();
    progress_.left_out_frames = gate.left_out_count();
    if (request_.pacing.newest_wins) adapt_to_link(now, encoder, gate);
    if (connection_.can_send()) {
      if (auto encoded = gate.take(now, credit_.available())) {
        if (Status status = send_frame(*std::move(encoded)); !status.ok()) return status;
        continue;  // the next one can get ready while this one is written
      }
    }
    if (Status status = step(gate.next_event(now)); !status.ok()) return status;
    if (finished_) return Error{ErrorCode::kIo, "the server ended the scan before it had every frame"};
  }
  progress_.left_out_frames = gate.left_out_count();
  return Done{};
}

void Session::adapt_to_link(SteadyTime now, FrameEncoder& encoder, FrameGate& gate) {
  if (now < judge_link_at_) return;
  judge_link_at_ = now + std::chrono::seconds(1);
  const LinkCounts counts{gate.due_count(), gate.dropped_count()};
  link_ = after_a_second(link_, {counts.due - counted_.due, counts.dropped - counted_.dropped});
  counted_ = counts;
  const LinkLevel level = link_level(link_.level);
  encoder.set_jpeg_quality(level.jpeg_quality);
  gate.keep(level.kept_frames, level.of_frames);
  progress_.link_level = link_.level;
}

Status Session::finish() {
  progress_.finishing = true;
  while (!connection_.can_send()) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  connection_.send(wire::format_client_message(wire::Finish{}));
  while (!finished_) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  tell_progress();
  return Done{};
}

// Waits for news, at most until `next_event`, and takes in all that came.
Status Session::step(std::optional<SteadyTime> next_event) {
  const std::uint64_t sent_bytes = connection_.sent_bytes();
  connection_.wait_until(std::min(next_event.value_or(SteadyTime::max()), Clock::now() + kTick));
  while (auto message = connection_.take_message()) {
    if (Status status = handle(*message); !status.ok()) return status;
  }
  const SteadyTime now = Clock::now();
  if (connection_.sent_bytes() != sent_bytes || !server_has_work()) last_news_ = now;
  tell_progress();
  if (failure_) return *failure_;
  if (finished_) return Done{};
  if (interrupts() > 1) return Error{ErrorCode::kIo, "given up: interrupted twice"};
  if (const auto& ended = connection_.ended()) return *ended;
  if (now - last_news_ > request_.silence_patience) {
    const auto patience_s = std::chrono::duration_cast<std::chrono::seconds>(request_.silence_patience).count();
    return Error{ErrorCode::kIo, "no word from the server for " + std::to_string(patience_s) + " s although it has work to do"};
  }
  return Done{};
}

bool Session::server_has_work() const {
  const std::uint64_t answered = progress_.processed_frames + progress_.server_dropped_frames;
  return !welcome_ || progress_.finishing || !connection_.can_send() || credit_.sent() > answered;
}

Status Session::handle(const std::string& bytes) {
  const auto message = wire::parse_server_message(bytes);
  if (!message.ok()) return in_context("a message of the server", message.error());
  if (!std::holds_alternative<wire::Pong>(*message)) last_news_ = Clock::now();
  std::visit([this](const auto& body) { receive(body); }, *message);
  return Done{};
}

Status Session::send_frame(EncodedFrame encoded) {
  if (!encoded.problem.empty()) tell_problem(encoded.problem);
  encoded.frame.sequence = credit_.sent();
  std::string message = wire::format_client_message(std::move(encoded.frame));
  if (message.size() > welcome_->max_message_bytes) {
    return Error{ErrorCode::kTooLarge, "frame " + std::to_string(encoded.index) + " takes " + std::to_string(message.size()) +
                                           " bytes, the server accepts " + std::to_string(welcome_->max_message_bytes)};
  }
  credit_.take();
  progress_.sent_frames = credit_.sent();
  connection_.send(std::move(message));
  return Done{};
}

void Session::receive(const wire::Welcome& welcome) {
  if (welcome_) return;
  welcome_ = welcome;
  welcomed_at_ = Clock::now();
  progress_.scan_id = welcome.scan_id;
  credit_.grant_in_all(welcome.frame_credit);
}

void Session::receive(const wire::FrameResult& result) {
  ++progress_.processed_frames;
  if (result.status != wire::TrackingStatus::kLost) ++progress_.tracked_frames;
  progress_.last_result = result;
  if (result.event != wire::MapEvent::kNone && observer_.on_event) observer_.on_event(result);
}

void Session::receive(const wire::ScanState& state) {
  progress_.server_dropped_frames = state.frames_dropped;
  if (state.phase == wire::ScanPhase::kFinished) progress_.last_words = state.words;
  if (state.phase == wire::ScanPhase::kFailed || state.phase == wire::ScanPhase::kInterrupted) {
    if (!failure_) failure_ = Error{ErrorCode::kIo, "the scan failed on the server: " + state.words};
  }
}

void Session::receive(const wire::ErrorMessage& error) {
  if (!error.about_frame) {
    failure_ = error_from(error);
    return;
  }
  tell_problem("frame number " + std::to_string(error.sequence) + ": " + error_from(error).message);
}

void Session::tell_problem(const std::string& words) {
  ++progress_.problem_frames;
  if (observer_.on_problem) observer_.on_problem(words);
}

void Session::tell_progress() {
  progress_.sent_bytes = connection_.sent_bytes();
  progress_.elapsed_s = welcome_ ? seconds_between(welcomed_at_, Clock::now()) : 0;
  if (observer_.on_progress && welcome_) observer_.on_progress(progress_);
}

}  // namespace

Result<StreamOutcome> stream_sequence(const Sequence& sequence, const StreamRequest& request, const StreamObserver& observer) {
  auto connection = Connection::open(request.server, request.connect_patience);
  if (!connection.ok()) return connection.error();
  Session session(sequence, request, observer, **connection);
  Status status = session.greet();
  if (status.ok()) status = session.pump();
  if (status.ok()) status = session.finish();
  (*connection)->close(kClosePatience);
  if (!status.ok()) return status.error();
  return session.outcome();
}

}  // namespace hermite
