// A camera that runs on a thread of its own until it is stopped, and what whoever holds it wishes meanwhile.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/frame/rgbd_frame.h"
#include "server/capture/camera.h"

namespace hermite {

struct CaptureWishes {
  bool paused = false;      // frames are thrown away
  int interrupt_count = 0;  // 1: no more frames. 2: give up everything
};

struct CaptureState {
  std::uint64_t frame_count = 0;     // handed on, and counted
  double first_s = 0, newest_s = 0;  // their times
  double rate_hz = 0;                // of the last second of them
  double coverage = 0;               // share of pixels with depth, of the newest
  bool paused = false;
  bool ended = false;              // nothing more is handed on
  std::optional<Error> failure{};  // of the camera, when that is why
};

class Capture {
 public:
  struct Settings {
    std::uint64_t max_frames = 0;              // then it ends; 0: when it is wished
    std::chrono::milliseconds silence{5'000};  // without a frame the camera is taken to be gone
  };

  // All called on the camera's thread.
  struct Events {
    std::function<bool(RgbdFrame)> on_frame;  // must not block; whether it counts: false while nobody listens yet
    std::function<void()> on_end;             // once
    std::function<CaptureWishes()> wishes;    // several times a second until the end of this object
  };

  // `camera` must outlive this, and be left alone.
  Capture(CaptureCamera& camera, const Settings& settings, Events events);
  ~Capture();
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  CaptureState state() const;                               // from any thread
  int interrupt_count() const { return interrupt_count_; }  // the newest wish

 private:
  void run();
  bool step(const CaptureWishes& wishes);
  void hand_on(RgbdFrame frame);
  void end(std::optional<Error> failure);

  CaptureCamera& camera_;
  const Settings settings_;
  const Events events_;
  std::atomic<bool> stopping_{false};
  std::atomic<int> interrupt_count_{0};
  mutable std::mutex mutex_;
  CaptureState state_;                                   // guarded by mutex_
  std::chrono::steady_clock::time_point last_frame_at_;  // the camera's thread only, as the next two
  double second_began_s_ = 0;
  std::uint64_t frames_in_second_ = 0;
  std::thread thread_;
};

}  // namespace hermite
