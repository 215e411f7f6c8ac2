#include "server/capture/scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "server/capture/live_frames.h"
#include "server/client/backoff.h"
#include "server/client/depth_codec_choice.h"

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTick(100);
// Each attempt sends the server all frames again: what fails three times will fail a fourth time.
constexpr int kMaxScansOfOneLog = 3;

// Errors that do not go away by waiting.
bool is_hopeless(ErrorCode code) { return code != ErrorCode::kIo && code != ErrorCode::kBusy; }

class Scan {
 public:
  Scan(CaptureCamera& camera, const ScanRequest& request, const ScanObserver& observer)
      : camera_(camera), request_(request), observer_(observer) {}
  Result<ScanOutcome> run();

 private:
  Status look_first();
  Status start_camera();
  Result<std::optional<StreamOutcome>> stream();
  Result<StreamOutcome> forward(const StreamRequest& request);
  Status wait_for_server(std::chrono::milliseconds wait);
  void wait_for_camera();
  StreamObserver stream_observer();
  CaptureWishes wishes();
  ScanProgress progress() const;
  void tell_progress();
  void tell(const std::string& message) {
    if (observer_.on_message) observer_.on_message(message);
  }

  CaptureCamera& camera_;
  const ScanRequest& request_;
  const ScanObserver& observer_;
  std::vector<wire::DepthCodec> depth_codecs_;  // best first
  StreamProgress stream_progress_;
  std::unique_ptr<LocalLog> log_;
  std::optional<LiveFrames> live_;
  std::optional<Clock::time_point> camera_ended_at_;
  std::optional<Capture> capture_;  // last member: destroyed before what it feeds
};

// The whole scan.
Result<ScanOutcome> Scan::run() {
  if (Status status = look_first(); !status.ok()) return status.error();
  if (Status status = start_camera(); !status.ok()) return status.error();
  auto outcome = stream();
  if (!outcome.ok() && !log_) return outcome.error();
  if (!outcome.ok())
    return Error{outcome.error().code,
                 fmt::format("{}; what was recorded is in {}, and hermite-client stream sends it",
                             outcome.error().message, request_.record_folder)};
  return ScanOutcome{*std::move(outcome), progress()};
}

CaptureWishes Scan::wishes() {
  CaptureWishes wishes = observer_.wishes ? observer_.wishes() : CaptureWishes{};
  // If frames cannot be stored, the camera need not continue.
  if (log_ && log_->state().failure) wishes.interrupt_count = std::max(wishes.interrupt_count, 1);
  return wishes;
}

// The pre-flight check: reports problems, and chooses the codec for this camera. Checks only after
// all frames have arrived: a camera that has to wait drops frames, for which the computer would be
// blamed.
Status Scan::look_first() {
  CHECK(request_.preflight_frames >= kMinPreflightFrames &&
            request_.preflight_frames <= kMaxPreflightFrames,
        "some frames are looked at");
  struct Arrived {
    frame::RgbdFrame frame;
    double host_s;
  };
  std::vector<Arrived> frames;
  auto last_arrival = Clock::now();
  while (frames.size() < static_cast<std::size_t>(request_.preflight_frames)) {
    if (wishes().interrupt_count > 0)
      return Error{ErrorCode::kIo, "interrupted before the scan began"};
    auto frame = camera_.next(kTick);
    if (!frame.ok()) return frame.error();
    const auto now = Clock::now();
    if (*frame) {
      frames.push_back(
          {**std::move(frame), std::chrono::duration<double>(now.time_since_epoch()).count()});
      last_arrival = now;
    } else if (now - last_arrival >= request_.camera_patience) {
      return Error{
          ErrorCode::kDevice,
          fmt::format(
              "the camera gave {} frames, and then none for {} s: is it plugged in, with power?",
              frames.size(), request_.camera_patience.count() / 1000)};
    }
  }
  Preflight preflight(camera_.description());
  for (const Arrived& arrived : frames)
    preflight.add(arrived.frame, arrived.host_s, camera_.left_out());
  tell("looked at " + preflight.summary());
  for (const std::string& doubt : preflight.doubts()) tell("careful: " + doubt);
  std::vector<DepthImage> depths;
  for (int i = 0; i < kMinPreflightFrames; ++i)
    depths.push_back(std::move(frames[static_cast<std::size_t>(i)].frame.depth));
  // A third of the time between two frames, as for recordings.
  depth_codecs_ =
      best_first(try_depth_codecs(depths), 1000 / camera_.description().frame_rate_hz / 3);
  return Done{};
}

Status Scan::start_camera() {
  CHECK(request_.stream || !request_.record_folder.empty(), "the frames go somewhere");
  const Camera& camera = camera_.description().camera;
  Capture::Events events;
  if (request_.record_folder.empty()) {
    live_.emplace(camera, depth_codecs_);
    events.on_frame = [this](frame::RgbdFrame frame) { return live_->offer(std::move(frame)); };
    events.on_end = [this] { live_->close(); };
  } else {
    auto log =
        LocalLog::create(request_.record_folder, request_.title, camera, depth_codecs_.front());
    if (!log.ok()) return log.error();
    log_ = *std::move(log);
    events.on_frame = [this](frame::RgbdFrame frame) {
      log_->offer(std::move(frame));
      return true;
    };
    events.on_end = [this] { log_->finish(); };
  }
  events.wishes = [this] { return wishes(); };
  capture_.emplace(camera_, Capture::Settings{.max_frames = request_.max_frames},
                   std::move(events));
  return Done{};
}

Result<std::optional<StreamOutcome>> Scan::stream() {
  if (!request_.stream) {
    wait_for_camera();
    return std::optional<StreamOutcome>();
  }
  StreamRequest request = *request_.stream;
  request.pacing = {.rate_hz = std::nullopt, .newest_wins = live_.has_value()};
  Result<StreamOutcome> outcome =
      log_ ? forward(request) : stream_frames(*live_, request, stream_observer());
  if (!outcome.ok()) return outcome.error();
  return std::optional<StreamOutcome>(*std::move(outcome));
}

// Streams from the local log until the server has all of it.
Result<StreamOutcome> Scan::forward(const StreamRequest& request) {
  Backoff backoff(std::random_device{}());
  for (int scans = 0;;) {
    stream_progress_ = {};
    LocalLogFrames frames(*log_);
    Result<StreamOutcome> outcome = stream_frames(frames, request, stream_observer());
    if (frames.failure()) return *frames.failure();
    if (outcome.ok() || capture_->interrupt_count() > 1) return outcome;
    const bool had_begun = !stream_progress_.scan_id.empty();
    if (had_begun) ++scans;
    if (is_hopeless(outcome.error().code) || scans >= kMaxScansOfOneLog) {
      if (!had_begun) return outcome;
      tell(outcome.error().message + "; the recording goes on");
      wait_for_camera();
      return outcome;
    }
    tell(outcome.error().message + (had_begun ? "; all is sent again as a new scan"
                                              : "; the recording goes on, trying again"));
    if (Status status = wait_for_server(backoff.next()); !status.ok())
      return in_context(status.error().message, outcome.error());
  }
}

Status Scan::wait_for_server(std::chrono::milliseconds wait) {
  const auto until = Clock::now() + wait;
  do {
    if (capture_->interrupt_count() > 1)
      return Error{ErrorCode::kIo, "given up: interrupted twice"};
    if (camera_ended_at_ && Clock::now() - *camera_ended_at_ > request_.server_patience)
      return Error{ErrorCode::kIo, "the server was away for too long"};
    tell_progress();
    std::this_thread::sleep_for(std::min<Clock::duration>(
        kTick, std::max<Clock::duration>(until - Clock::now(), Clock::duration::zero())));
  } while (Clock::now() < until);
  return Done{};
}

void Scan::wait_for_camera() {
  const auto all_is_kept = [this] {
    return capture_->state().ended && (!log_ || log_->state().ended);
  };
  while (!all_is_kept() && capture_->interrupt_count() < 2) {
    tell_progress();
    std::this_thread::sleep_for(kTick);
  }
}

StreamObserver Scan::stream_observer() {
  StreamObserver observer;
  observer.on_progress = [this](const StreamProgress& progress) {
    stream_progress_ = progress;
    tell_progress();
  };
  observer.on_problem = observer.on_link = [this](const std::string& message) { tell(message); };
  observer.on_event = observer_.on_event;
  // The first interrupt ends the camera, and thereby the frames.
  observer.interrupt_count = [this] { return capture_->interrupt_count() > 1 ? 2 : 0; };
  observer.paused = [this] { return capture_->state().paused; };
  observer.on_pause_request = observer_.on_pause_request;
  return observer;
}

ScanProgress Scan::progress() const {
  ScanProgress now{stream_progress_, capture_->state(), std::nullopt, 0};
  now.dropped_frames = stream_progress_.dropped_frames + stream_progress_.server_dropped_frames;
  if (live_) now.dropped_frames += live_->dropped_count();
  if (log_) now.log = log_->state();
  if (now.log) now.dropped_frames += now.log->dropped_count;
  return now;
}

void Scan::tell_progress() {
  const ScanProgress now = progress();
  if (now.capture.ended && !camera_ended_at_) {
    camera_ended_at_ = Clock::now();
    if (now.capture.failure) tell("the camera has ended: " + now.capture.failure->message);
    if (now.log && now.log->failure) tell("the recording has ended: " + now.log->failure->message);
  }
  if (observer_.on_progress) observer_.on_progress(now);
}

}  // namespace

Result<ScanOutcome> run_scan(CaptureCamera& camera, const ScanRequest& request,
                             const ScanObserver& observer) {
  return Scan(camera, request, observer).run();
}

}  // namespace hermite::client
