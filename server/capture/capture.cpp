#include "server/capture/capture.h"

#include <algorithm>
#include <utility>

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTick(50);  // maximum delay of a key or a signal

double coverage_of(const DepthImage& depth) {
  const auto valid = std::count_if(depth.pixels.begin(), depth.pixels.end(),
                                   [](std::uint16_t value) { return value != 0; });
  return depth.pixels.empty()
             ? 0
             : static_cast<double>(valid) / static_cast<double>(depth.pixels.size());
}

}  // namespace

Capture::Capture(CaptureCamera& camera, const Settings& settings, Events events)
    : camera_(camera),
      settings_(settings),
      events_(std::move(events)),
      last_frame_at_(Clock::now()),
      thread_([this] { run(); }) {}

Capture::~Capture() {
  stopping_ = true;
  thread_.join();
}

CaptureState Capture::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void Capture::run() {
  bool ended = false;
  while (!stopping_) {
    const CaptureWishes wishes = events_.wishes();
    interrupt_count_ = wishes.interrupt_count;
    if (ended)
      std::this_thread::sleep_for(kTick);
    else
      ended = step(wishes);
  }
  if (!ended) end(std::nullopt);
}

// Waits for a frame. Returns whether the capture has ended.
bool Capture::step(const CaptureWishes& wishes) {
  const bool enough = settings_.max_frames > 0 && state().frame_count >= settings_.max_frames;
  if (enough || wishes.interrupt_count > 0) {
    end(std::nullopt);
    return true;
  }
  auto frame = camera_.next(kTick);
  if (!frame.ok()) {
    end(frame.error());
    return true;
  }
  if (*frame) last_frame_at_ = Clock::now();
  if (Clock::now() - last_frame_at_ > settings_.silence) {
    end(Error{ErrorCode::kDevice, "the camera is silent: was it unplugged?"});
    return true;
  }
  {
    const std::lock_guard lock(mutex_);
    state_.paused = wishes.paused;
  }
  if (*frame && !wishes.paused) hand_on(**std::move(frame));
  return false;
}

void Capture::hand_on(frame::RgbdFrame frame) {
  const double time_s = frame.timestamp_s, coverage = coverage_of(frame.depth);
  if (!events_.on_frame(std::move(frame))) return;
  const std::lock_guard lock(mutex_);
  if (state_.frame_count++ == 0) state_.first_s = second_began_s_ = time_s;
  state_.newest_s = time_s;
  state_.coverage = coverage;
  if (const double span_s = time_s - second_began_s_; span_s >= 1) {
    state_.rate_hz = static_cast<double>(frames_in_second_) / span_s;
    second_began_s_ = time_s;
    frames_in_second_ = 0;
  }
  ++frames_in_second_;
}

void Capture::end(std::optional<Error> failure) {
  {
    const std::lock_guard lock(mutex_);
    state_.ended = true;
    // The end of a recording is not a failure.
    if (failure && failure->code != ErrorCode::kNotFound) state_.failure = std::move(failure);
  }
  events_.on_end();
}

}  // namespace hermite::client
