#include "server/client/load_camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "server/client/backoff.h"
#include "server/client/load_answers.h"

namespace hermite::client {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLoadTick(50);

// Follows one scan by the callbacks of stream_frames(). One thread.
class FollowedScan {
 public:
  FollowedScan(const LoadCameras& shared, CameraLoad& load)
      : shared_(shared), load_(load), offered_(*shared.request.pacing.rate_hz) {}

  StreamObserver observer() {
    StreamObserver observer;
    observer.interrupt_count = [this] { return shared_.clock.wish(); };
    observer.on_progress = [this](const StreamProgress& progress) { see(progress, Clock::now()); };
    observer.on_link = [this](const std::string& message) { see_link(message); };
    observer.on_problem = [this](const std::string& message) {
      count_message(load_.other, message);
    };
    return observer;
  }

  // After stream_frames() has returned.
  void ended(const Result<StreamOutcome>& outcome);

  bool begun() const { return !progress_.scan_id.empty(); }

 private:
  void see(const StreamProgress& progress, SteadyTime now);
  void see_link(const std::string& message);
  void stop_waiting(SteadyTime now);
  void add_counts();

  const LoadCameras& shared_;
  CameraLoad& load_;
  StreamProgress progress_;
  AnswerTimes answers_;
  OfferedFrames offered_;
  std::optional<SteadyTime> waits_since_;  // for a place
};

void FollowedScan::see(const StreamProgress& progress, SteadyTime now) {
  if (!begun()) {
    stop_waiting(now);
    shared_.scans.begin(progress.scan_id);
    ++shared_.counters.scanning;
    ++load_.scans_begun;
  }
  shared_.counters.answered +=
      progress.processed_frames - std::min(progress.processed_frames, progress_.processed_frames);
  answers_.see(progress, now);
  offered_.see(progress, now);
  progress_ = progress;
}

// Before the scan has begun, a stream only speaks of its link when it has to wait for a place.
void FollowedScan::see_link(const std::string& message) {
  if (begun()) {
    count_message(load_.other, message);
  } else if (!waits_since_) {
    waits_since_ = Clock::now();
    ++shared_.counters.waiting;
  }
}

void FollowedScan::stop_waiting(SteadyTime now) {
  if (!waits_since_) return;
  --shared_.counters.waiting;
  load_.wait_s.push_back(
      std::chrono::duration<float>(now - *std::exchange(waits_since_, std::nullopt)).count());
}

void FollowedScan::ended(const Result<StreamOutcome>& outcome) {
  const int wish = shared_.clock.wish();
  if (waits_since_) {
    load_.without_place = wish > 0;
    stop_waiting(Clock::now());
  }
  if (!begun()) {
    if (wish > 0 || outcome.ok()) return;  // it was told to stop
    ++load_.refused;
    count_message(load_.refusals, outcome.error().message);
    return;
  }
  shared_.scans.end(progress_.scan_id);
  --shared_.counters.scanning;
  // Its turn came when the time was over.
  if (!outcome.ok() && wish > 0 && progress_.sent_frames == 0) {
    --load_.scans_begun;
    load_.without_place = true;
    return;
  }
  if (outcome.ok()) {
    ++load_.scans_finished;
    progress_ = outcome->progress;
  } else {
    ++load_.scans_failed;
    const bool too_late = wish > 1 && !shared_.clock.interrupted();
    count_message(load_.other, too_late ? fmt::format("no report within {} s after the end",
                                                      kLoadEndPatience.count())
                                        : outcome.error().message);
  }
  add_counts();
}

void FollowedScan::add_counts() {
  load_.due += offered_.due();
  load_.offered += offered_.offered();
  load_.sent += progress_.sent_frames;
  load_.answered += progress_.processed_frames;
  load_.tracked += progress_.tracked_frames;
  load_.client_dropped += progress_.dropped_frames;
  load_.server_dropped += progress_.server_dropped_frames;
  load_.left_out += progress_.left_out_frames;
  load_.problem_frames += progress_.problem_frames;
  load_.reconnects += progress_.resumed_count;
  load_.sent_bytes += progress_.sent_bytes;
  load_.answer_ms.insert(load_.answer_ms.end(), answers_.times_ms().begin(),
                         answers_.times_ms().end());
}

void wait_until(LoadClock& clock, SteadyTime time) {
  while (clock.wish() == 0 && Clock::now() < time)
    std::this_thread::sleep_until(std::min(time, Clock::now() + kLoadTick));
}

bool is_worth_another_try(const Error& error) {
  return error.code == ErrorCode::kIo || error.code == ErrorCode::kBusy ||
         error.code == ErrorCode::kUnavailable;
}

}  // namespace

LoadClock::LoadClock(std::chrono::duration<double> time, std::function<int()> interrupt_count)
    : over_at_(began_ + std::chrono::duration_cast<SteadyTime::duration>(time)),
      interrupt_count_(std::move(interrupt_count)) {}

int LoadClock::wish() {
  const int interrupts = interrupt_count_();
  const SteadyTime now = Clock::now();
  if (interrupts > 1) return 2;
  if (interrupts == 0 && now < over_at_) return 0;
  SteadyTime::rep since = 0;
  if (finishing_since_.compare_exchange_strong(since, now.time_since_epoch().count())) return 1;
  return now.time_since_epoch() - SteadyTime::duration(since) > kLoadEndPatience ? 2 : 1;
}

CameraLoad run_load_camera(const LoadCameras& shared, int number,
                           std::chrono::duration<double> delay) {
  CameraLoad load;
  wait_until(shared.clock,
             shared.clock.began() + std::chrono::duration_cast<SteadyTime::duration>(delay));
  Backoff backoff(std::random_device{}());
  while (shared.clock.wish() == 0) {
    StreamRequest request = shared.request;
    request.title += fmt::format(", camera {}, scan {}", number, load.scans_begun + 1);
    LoadCameraFrames frames(shared.frames);
    FollowedScan scan(shared, load);
    const StreamObserver observer = scan.observer();
    const Result<StreamOutcome> outcome = stream_frames(frames, request, observer);
    scan.ended(outcome);
    if (outcome.ok()) {
      backoff = Backoff(std::random_device{}());
      continue;
    }
    if (!is_worth_another_try(outcome.error())) break;
    wait_until(shared.clock, Clock::now() + backoff.next());
  }
  return load;
}

}  // namespace hermite::client
