#include "server/client/stream_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <random>
#include <thread>
#include <utility>

#include "proto/wire/client_message.h"
#include "server/client/backoff.h"

namespace hermite::client {

namespace {

using Clock = std::chrono::steady_clock;

// How long an interrupt or a report of progress may be delayed.
constexpr std::chrono::milliseconds kTick(100);
constexpr std::chrono::milliseconds kClosePatience(2000);

double seconds_between(SteadyTime from, SteadyTime to) {
  return std::chrono::duration<double>(to - from).count();
}

Status check_welcome(const wire::Welcome& welcome) {
  const auto& accepted = welcome.color_codecs;
  if (std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kJpeg) != accepted.end())
    return Done{};
  return Error{ErrorCode::kUnsupported, "the server accepts no JPEG colour"};
}

}  // namespace

StreamSession::StreamSession(FrameSource& source, const StreamRequest& request,
                             const StreamObserver& observer)
    : source_(source),
      request_(request),
      observer_(observer),
      report_{observer, {}},
      link_(request.server, request.ca),
      frames_(source, request.pacing, report_),
      answers_({frames_, link_, report_}) {
  report_.progress.frame_count = static_cast<std::int64_t>(source.expected_frames());
}

// The whole scan: across lost connections, sends frames and Finish until the result has arrived.
Status StreamSession::run() {
  if (Status status = begin(); !status.ok()) return status;
  frames_.start(*answers_.welcome(), [this] { link_.wake(); });
  for (;;) {
    Status status = pump();
    if (status.ok()) status = finish();
    if (status.ok() || !link_lost_ || !answers_.is_resumable()) return status;
    if (Status back = resume(status.error()); !back.ok()) return back;
  }
}

void StreamSession::close() { link_.close(kClosePatience); }

StreamOutcome StreamSession::outcome() const {
  return {answers_.finished()->report_json, answers_.finished()->trajectory_tum, report_.progress};
}

// A client that waits for admission has nothing on the server that could be lost: after a lost
// connection it starts again, at the end of the queue.
Status StreamSession::begin() {
  if (Status status = connect(); !status.ok()) return status;
  Status status = greet();
  while (!status.ok() && link_lost_ && answers_.waiting()) {
    report_.tell_link("connection lost while waiting for a place, trying to get it back: " +
                      status.error().message);
    status = get_back(status.error(), [this] { return greet(); });
  }
  return status;
}

Status StreamSession::connect() {
  answers_.connected(Clock::now());
  if (Status status = link_.open(request_.connect_patience); !status.ok()) return status;
  link_lost_ = told_paused_ = false;
  quiet_since_ = Clock::now();
  return Done{};
}

Status StreamSession::greet() {
  wire::StartScan start;
  start.title = request_.title;
  start.camera = source_.camera();
  start.depth_codecs = source_.depth_codecs();
  start.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
  start.mode = request_.pacing.newest_wins ? wire::Mode::kLive : wire::Mode::kBatch;
  start.settings = request_.settings;
  start.expected_frames = source_.expected_frames();
  link_.connection().send(wire::format_client_message(wire::Hello{
      wire::kProtocolMinor, "hermite-client", request_.server.token, std::move(start)}));

  const SteadyTime greeted_at = Clock::now();
  const auto deadline = [&] {
    return std::max(greeted_at, answers_.waiting_said_at()) + request_.connect_patience;
  };
  while (!answers_.welcome()) {
    if (Status status = step(deadline()); !status.ok()) return status;
    if (interrupts() > 0) return Error{ErrorCode::kIo, "interrupted before the scan began"};
    if (!answers_.welcome() && Clock::now() >= deadline()) {
      link_lost_ = true;
      return Error{ErrorCode::kIo, "the server does not answer the hello"};
    }
  }
  return check_welcome(*answers_.welcome());
}

Status StreamSession::resume(const Error& lost) {
  report_.tell_link(fmt::format("connection lost with {} frames durable, trying to get it back: {}",
                                frames_.first_kept(), lost.message));
  if (Status status = get_back(lost, [this] { return ask_to_resume(); }); !status.ok())
    return status;
  ++report_.progress.resumed_count;
  report_.tell_link(fmt::format("connected again, going on with frame {}", frames_.sent_count()));
  return Done{};
}

// Connects and asks until the server accepts, refuses or queues the request, or
// `reconnect_patience` has passed.
Status StreamSession::get_back(const Error& lost, const std::function<Status()>& ask) {
  const SteadyTime deadline = Clock::now() + request_.reconnect_patience;
  Backoff backoff(std::random_device{}());
  Error last = lost;
  for (;;) {
    if (Status status = wait_before_connecting(std::max(backoff.next(), answers_.take_stay_away()));
        !status.ok())
      return status;
    if (Clock::now() >= deadline) return in_context("the connection could not be got back", last);
    Status status = connect();
    const bool nobody_there = !status.ok() && (status.error().code == ErrorCode::kIo ||
                                               status.error().code == ErrorCode::kBusy);
    if (!status.ok() && !nobody_there) return status;
    if (status.ok()) status = ask();
    const bool answered = !nobody_there && (!link_lost_ || answers_.waiting());
    if (status.ok() || answered) return status;
    last = status.error();
  }
}

Status StreamSession::wait_before_connecting(std::chrono::milliseconds wait) {
  const SteadyTime until = Clock::now() + wait;
  while (Clock::now() < until) {
    if (interrupts() > 1) return Error{ErrorCode::kIo, "given up: interrupted twice"};
    if (!answers_.welcome() && interrupts() > 0)
      return Error{ErrorCode::kIo, "interrupted before the scan began"};
    frames_.offer(Clock::now(), answers_.holds_frames());  // a live camera does not wait
    tell_progress();
    std::this_thread::sleep_until(std::min(until, Clock::now() + kTick));
  }
  return Done{};
}

Status StreamSession::ask_to_resume() {
  const wire::Welcome& welcome = *answers_.welcome();
  link_.connection().send(wire::format_client_message(
      wire::Hello{wire::kProtocolMinor, "hermite-client", request_.server.token,
                  wire::ResumeScan{welcome.scan_id, welcome.resume_token, frames_.first_kept()}}));
  const SteadyTime deadline = Clock::now() + request_.connect_patience;
  while (!answers_.resumed()) {
    if (Status status = step(deadline); !status.ok()) return status;
    if (!answers_.resumed() && Clock::now() >= deadline) {
      link_lost_ = true;
      return Error{ErrorCode::kIo, "the server does not answer the request to resume"};
    }
  }
  return frames_.resume(*answers_.resumed());
}

// Sends frames again that the server lacks, then new ones, until all were sent.
Status StreamSession::pump() {
  for (;;) {
    const SteadyTime now = Clock::now();
    const bool held = answers_.holds_frames();
    frames_.offer(now, held);
    const bool all_taken = interrupts() > 0 || frames_.exhausted();
    if (all_taken && !frames_.next()) return Done{};
    if (link_.connection().can_send() && frames_.has_credit()) {
      if (!held && !all_taken)
        if (Status status = frames_.number_next(now); !status.ok()) return status;
      if (frames_.next()) {
        send_next_frame();
        continue;  // the next frame can be prepared while this one is written
      }
    }
    if (Status status = step(frames_.next_event(now)); !status.ok()) return status;
    if (answers_.finished())
      return Error{ErrorCode::kIo, "the server ended the scan before it had every frame"};
  }
}

Status StreamSession::finish() {
  report_.progress.finishing = true;
  while (!link_.connection().can_send() && !answers_.finished()) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  if (!answers_.finished()) link_.connection().send(wire::format_client_message(wire::Finish{}));
  while (!answers_.finished()) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  tell_progress();
  return Done{};
}

// Waits for an event, at most until `next_event`, and handles all received messages.
Status StreamSession::step(std::optional<SteadyTime> next_event) {
  const std::uint64_t sent_bytes = link_.connection().sent_bytes();
  link_.connection().wait_until(
      std::min(next_event.value_or(SteadyTime::max()), Clock::now() + kTick));
  while (auto message = link_.connection().take_message()) {
    if (Status status = answers_.take(*message, Clock::now()); !status.ok()) return status;
  }
  const SteadyTime now = Clock::now();
  if (link_.connection().sent_bytes() != sent_bytes || !server_has_work()) quiet_since_ = now;
  tell_progress();
  if (answers_.failure()) return *answers_.failure();
  if (answers_.finished()) return Done{};
  if (interrupts() > 1) return Error{ErrorCode::kIo, "given up: interrupted twice"};
  // There is no need to wait until a server that stops has closed the connection.
  link_lost_ = answers_.is_stopping() || link_.connection().ended();
  if (answers_.is_stopping())
    return Error{ErrorCode::kIo, "the server is stopping, or has only just started"};
  if (link_lost_) return *link_.connection().ended();
  follow_pause(now);
  link_.ping(now);
  if (now - std::max(quiet_since_, answers_.last_news()) > request_.silence_patience) {
    const auto patience_s =
        std::chrono::duration_cast<std::chrono::seconds>(request_.silence_patience).count();
    return Error{
        ErrorCode::kIo,
        fmt::format("no word from the server for {} s although it has work to do", patience_s)};
  }
  return Done{};
}

bool StreamSession::server_has_work() {
  const StreamProgress& progress = report_.progress;
  const std::uint64_t answered = progress.processed_frames + progress.server_dropped_frames;
  return !answers_.welcome() || progress.finishing || !link_.connection().can_send() ||
         frames_.sent_count() > answered;
}

void StreamSession::send_next_frame() {
  link_.connection().send(*frames_.next());
  frames_.sent();
  told_paused_ = false;
}

void StreamSession::follow_pause(SteadyTime now) {
  const bool held = answers_.holds_frames();
  const bool paused =
      (held || (observer_.paused && observer_.paused())) && !report_.progress.finishing;
  if (paused_ && !paused) frames_.go_on(now);
  paused_ = paused;
  // Not before the last frame was sent, since a frame ends a pause.
  const bool knows_pauses =
      answers_.welcome() && answers_.welcome()->protocol_minor >= wire::kMinorWithResume;
  const bool all_sent = !frames_.next() && (held || !frames_.has_waiting());
  if (paused == told_paused_ || !knows_pauses || !link_.connection().can_send() || !all_sent)
    return;
  if (paused) link_.connection().send(wire::format_client_message(wire::Pause{}));
  if (!paused) link_.connection().send(wire::format_client_message(wire::Unpause{}));
  told_paused_ = paused;
}

void StreamSession::tell_progress() {
  StreamProgress& progress = report_.progress;
  const bool welcomed = answers_.welcome().has_value();
  progress.sent_bytes = link_.sent_bytes();
  progress.round_trip_ms = link_.round_trip_ms();
  progress.elapsed_s = welcomed ? seconds_between(answers_.welcomed_at(), Clock::now()) : 0;
  if (observer_.on_progress && welcomed) observer_.on_progress(progress);
}

}  // namespace hermite::client
