#include "server/client/stream_session.h"

#include <algorithm>
#include <random>
#include <thread>
#include <utility>

#include "proto/wire/client_message.h"
#include "server/client/backoff.h"

namespace hermite {

namespace {

using Clock = std::chrono::steady_clock;

// How long an interrupt or a report of progress may be delayed.
constexpr std::chrono::milliseconds kTick(100);
constexpr std::chrono::milliseconds kClosePatience(2000);
// A server grants no more than its window (at most 256 frames) beyond the durable frames; one that grants more must not
// exhaust the memory.
constexpr std::size_t kMaxKeptFrames = 256;

double seconds_between(SteadyTime from, SteadyTime to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

// The whole scan: across lost connections, sends frames and Finish until the result has arrived.
Status StreamSession::run() {
  if (Status status = begin(); !status.ok()) return status;
  const auto& accepted = welcome_->color_codecs;
  const bool png_color = std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kPng) != accepted.end();
  encoder_.emplace(source_, FrameEncoder::Settings{.encoding = {welcome_->depth_codec, png_color}}, [this] { link_.wake(); });
  for (;;) {
    Status status = pump();
    if (status.ok()) status = finish();
    if (status.ok() || !link_lost_ || !resumable()) return status;
    if (Status back = resume(status.error()); !back.ok()) return back;
  }
}

void StreamSession::close() { link_.close(kClosePatience); }

// A client that waits for admission has nothing on the server that could be lost: after a lost connection it starts
// again, at the end of the queue.
Status StreamSession::begin() {
  if (Status status = connect(); !status.ok()) return status;
  Status status = greet();
  while (!status.ok() && link_lost_ && waiting_) {
    tell_link("connection lost while waiting for a place, trying to get it back: " + status.error().message);
    status = get_back(status.error(), [this] { return greet(); });
  }
  return status;
}

Status StreamSession::connect() {
  waiting_.reset();
  if (Status status = link_.open(request_.connect_patience); !status.ok()) return status;
  link_lost_ = told_paused_ = false;
  last_news_ = Clock::now();
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
  link_.connection().send(
      wire::format_client_message(wire::Hello{wire::kProtocolMinor, "hermite-client", request_.server.token, std::move(start)}));

  hello_deadline_ = Clock::now() + request_.connect_patience;
  while (!welcome_) {
    if (Status status = step(hello_deadline_); !status.ok()) return status;
    if (interrupts() > 0) return Error{ErrorCode::kIo, "interrupted before the scan began"};
    if (!welcome_ && Clock::now() >= hello_deadline_) {
      link_lost_ = true;
      return Error{ErrorCode::kIo, "the server does not answer the hello"};
    }
  }
  return check_welcome();
}

Status StreamSession::resume(const Error& lost) {
  tell_link("connection lost with " + std::to_string(frames_.first_kept()) + " frames durable, trying to get it back: " + lost.message);
  if (Status status = get_back(lost, [this] { return ask_to_resume(); }); !status.ok()) return status;
  ++progress_.resumed_count;
  tell_link("connected again, going on with frame " + std::to_string(frames_.sent_count()));
  return Done{};
}

// Connects and asks until the server accepts, refuses or queues the request, or `reconnect_patience` has passed.
Status StreamSession::get_back(const Error& lost, const std::function<Status()>& ask) {
  const SteadyTime deadline = Clock::now() + request_.reconnect_patience;
  Backoff backoff(std::random_device{}());
  Error last = lost;
  for (;;) {
    if (Status status = wait_before_connecting(
            std::max(backoff.next(), std::exchange(stay_away_, std::nullopt).value_or(std::chrono::milliseconds(0))));
        !status.ok())
      return status;
    if (Clock::now() >= deadline) return in_context("the connection could not be got back", last);
    Status status = connect();
    const bool nobody_there = !status.ok() && (status.error().code == ErrorCode::kIo || status.error().code == ErrorCode::kBusy);
    if (!status.ok() && !nobody_there) return status;
    if (status.ok()) status = ask();
    const bool answered = !nobody_there && (!link_lost_ || waiting_);
    if (status.ok() || answered) return status;
    last = status.error();
  }
}

Status StreamSession::wait_before_connecting(std::chrono::milliseconds wait) {
  const SteadyTime until = Clock::now() + wait;
  while (Clock::now() < until) {
    if (interrupts() > 1) return Error{ErrorCode::kIo, "given up: interrupted twice"};
    if (!welcome_ && interrupts() > 0) return Error{ErrorCode::kIo, "interrupted before the scan began"};
    if (encoder_) offer_frames(Clock::now());  // a live camera does not wait
    tell_progress();
    std::this_thread::sleep_until(std::min(until, Clock::now() + kTick));
  }
  return Done{};
}

Status StreamSession::ask_to_resume() {
  resumed_.reset();
  link_.connection().send(
      wire::format_client_message(wire::Hello{wire::kProtocolMinor, "hermite-client", request_.server.token,
                                              wire::ResumeScan{welcome_->scan_id, welcome_->resume_token, frames_.first_kept()}}));
  const SteadyTime deadline = Clock::now() + request_.connect_patience;
  while (!resumed_) {
    if (Status status = step(deadline); !status.ok()) return status;
    if (!resumed_ && Clock::now() >= deadline) {
      link_lost_ = true;
      return Error{ErrorCode::kIo, "the server does not answer the request to resume"};
    }
  }
  frames_.durable(resumed_->durable_frames);
  if (Status status = frames_.resume_at(resumed_->next_sequence); !status.ok()) return status;
  credit_ = CreditWindow(resumed_->frames_granted, resumed_->next_sequence);
  return Done{};
}

Status StreamSession::check_welcome() const {
  const auto& accepted = welcome_->color_codecs;
  if (std::find(accepted.begin(), accepted.end(), wire::ColorCodec::kJpeg) == accepted.end()) {
    return Error{ErrorCode::kUnsupported, "the server accepts no JPEG colour"};
  }
  return Done{};
}

// Sends frames again that the server lacks, then new ones, until all were sent.
Status StreamSession::pump() {
  for (;;) {
    const SteadyTime now = Clock::now();
    offer_frames(now);
    const bool all_taken = interrupts() > 0 || (encoder_->exhausted() && gate_.empty());
    if (all_taken && !frames_.next()) return Done{};
    if (link_.connection().can_send() && credit_.available()) {
      const bool room = !held_ && !all_taken && !frames_.next() && frames_.kept_count() < kMaxKeptFrames;
      if (auto encoded = gate_.take(now, room)) {
        if (Status status = number(*std::move(encoded)); !status.ok()) return status;
      }
      if (frames_.next()) {
        send_next_frame();
        continue;  // the next frame can be prepared while this one is written
      }
    }
    if (Status status = step(gate_.next_event(now)); !status.ok()) return status;
    if (finished_) return Error{ErrorCode::kIo, "the server ended the scan before it had every frame"};
  }
}

void StreamSession::offer_frames(SteadyTime now) {
  while (!held_ && gate_.wants(now)) {
    auto encoded = encoder_->take();
    if (!encoded) break;
    gate_.offer(*std::move(encoded), now);
  }
  progress_.dropped_frames = gate_.dropped_count();
  progress_.left_out_frames = gate_.left_out_count();
  if (request_.pacing.newest_wins) adapt_to_link(now);
}

void StreamSession::adapt_to_link(SteadyTime now) {
  if (now < judge_link_at_) return;
  judge_link_at_ = now + std::chrono::seconds(1);
  const LinkCounts counts{gate_.due_count(), gate_.dropped_count()};
  link_state_ = after_a_second(link_state_, {counts.due - counted_.due, counts.dropped - counted_.dropped});
  counted_ = counts;
  const LinkLevel level = link_level(link_state_.level);
  encoder_->set_jpeg_quality(level.jpeg_quality);
  gate_.keep(level.kept_frames, level.of_frames);
  progress_.link_level = link_state_.level;
}

Status StreamSession::finish() {
  progress_.finishing = true;
  while (!link_.connection().can_send() && !finished_) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  if (!finished_) link_.connection().send(wire::format_client_message(wire::Finish{}));
  while (!finished_) {
    if (Status status = step(std::nullopt); !status.ok()) return status;
  }
  tell_progress();
  return Done{};
}

// Waits for an event, at most until `next_event`, and handles all received messages.
Status StreamSession::step(std::optional<SteadyTime> next_event) {
  const std::uint64_t sent_bytes = link_.connection().sent_bytes();
  link_.connection().wait_until(std::min(next_event.value_or(SteadyTime::max()), Clock::now() + kTick));
  while (auto message = link_.connection().take_message()) {
    if (Status status = handle(*message); !status.ok()) return status;
  }
  const SteadyTime now = Clock::now();
  if (link_.connection().sent_bytes() != sent_bytes || !server_has_work()) last_news_ = now;
  tell_progress();
  if (failure_) return *failure_;
  if (finished_) return Done{};
  if (interrupts() > 1) return Error{ErrorCode::kIo, "given up: interrupted twice"};
  // There is no need to wait until a server that stops has closed the connection.
  link_lost_ = stay_away_ || link_.connection().ended();
  if (stay_away_) return Error{ErrorCode::kIo, "the server is stopping, or has only just started"};
  if (link_lost_) return *link_.connection().ended();
  follow_pause(now);
  link_.ping(now);
  if (now - last_news_ > request_.silence_patience) {
    const auto patience_s = std::chrono::duration_cast<std::chrono::seconds>(request_.silence_patience).count();
    return Error{ErrorCode::kIo, "no word from the server for " + std::to_string(patience_s) + " s although it has work to do"};
  }
  return Done{};
}

bool StreamSession::server_has_work() {
  const std::uint64_t answered = progress_.processed_frames + progress_.server_dropped_frames;
  return !welcome_ || progress_.finishing || !link_.connection().can_send() || credit_.sent() > answered;
}

// Numbers the frame, and keeps it until the server has it.
Status StreamSession::number(EncodedFrame encoded) {
  if (!encoded.problem.empty()) tell_problem(encoded.problem);
  encoded.frame.sequence = frames_.numbered_count();
  std::string message = wire::format_client_message(std::move(encoded.frame));
  if (message.size() > welcome_->max_message_bytes) {
    return Error{ErrorCode::kTooLarge, "frame " + std::to_string(encoded.index) + " takes " + std::to_string(message.size()) +
                                           " bytes, the server accepts " + std::to_string(welcome_->max_message_bytes)};
  }
  frames_.add(std::move(message));
  return Done{};
}

void StreamSession::send_next_frame() {
  link_.connection().send(*frames_.next());
  frames_.sent();
  told_paused_ = false;
  credit_.take();
  progress_.sent_frames = std::max(progress_.sent_frames, frames_.sent_count());
  // A server that does not support resuming never requests a frame again.
  if (!resumable()) frames_.durable(frames_.sent_count());
}

void StreamSession::tell_problem(const std::string& message) {
  ++progress_.problem_frames;
  if (observer_.on_problem) observer_.on_problem(message);
}

void StreamSession::tell_link(const std::string& message) {
  if (observer_.on_link) observer_.on_link(message);
}

void StreamSession::follow_pause(SteadyTime now) {
  const bool paused = (held_ || (observer_.paused && observer_.paused())) && !progress_.finishing;
  if (paused_ && !paused) gate_.go_on(now);
  paused_ = paused;
  // Not before the last frame was sent, since a frame ends a pause.
  const bool knows_pauses = welcome_ && welcome_->protocol_minor >= wire::kMinorWithResume;
  const bool all_sent = !frames_.next() && (held_ || gate_.empty());
  if (paused == told_paused_ || !knows_pauses || !link_.connection().can_send() || !all_sent) return;
  if (paused) link_.connection().send(wire::format_client_message(wire::Pause{}));
  if (!paused) link_.connection().send(wire::format_client_message(wire::Unpause{}));
  told_paused_ = paused;
}

void StreamSession::tell_progress() {
  progress_.sent_bytes = link_.sent_bytes();
  progress_.round_trip_ms = link_.round_trip_ms();
  progress_.elapsed_s = welcome_ ? seconds_between(welcomed_at_, Clock::now()) : 0;
  if (observer_.on_progress && welcome_) observer_.on_progress(progress_);
}

}  // namespace hermite
