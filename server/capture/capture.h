// Runs a camera on its own thread until it is stopped, and polls the wishes of the user meanwhile.
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

namespace hermite::client {

struct CaptureWishes {
  bool paused = false;      // frames are discarded
  int interrupt_count = 0;  // 1: no more frames. 2: abort everything
};

struct CaptureState {
  std::uint64_t frame_count = 0;     // passed on and counted
  double first_s = 0, newest_s = 0;  // their timestamps
  double rate_hz = 0;                // over the last second of frames
  double coverage = 0;               // share of pixels with depth, in the newest frame
  bool paused = false;
  bool ended = false;              // no more frames are passed on
  std::optional<Error> failure{};  // of the camera, if that ended the capture
};

class Capture {
 public:
  struct Settings {
    // Ends after that many; 0: only when the user ends it.
    std::uint64_t max_frames = 0;
    // The camera counts as gone after this time without a frame.
    std::chrono::milliseconds silence{5'000};
  };

  // All are called on the camera's thread.
  struct Events {
    // Must not block. Returns whether the frame counts; false while the consumer has not started.
    std::function<bool(frame::RgbdFrame)> on_frame;
    std::function<void()> on_end;  // called once
    // Called several times per second until this object is destroyed.
    std::function<CaptureWishes()> wishes;
  };

  // `camera` must outlive this object, which has exclusive use of it.
  Capture(CaptureCamera& camera, const Settings& settings, Events events);
  ~Capture();
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  CaptureState state() const;                               // from any thread
  int interrupt_count() const { return interrupt_count_; }  // the newest wish

 private:
  void run();
  bool step(const CaptureWishes& wishes);
  void hand_on(frame::RgbdFrame frame);
  void end(std::optional<Error> failure);

  CaptureCamera& camera_;
  const Settings settings_;
  const Events events_;
  std::atomic<bool> stopping_{false};
  std::atomic<int> interrupt_count_{0};
  mutable std::mutex mutex_;
  CaptureState state_;  // guarded by mutex_
  // Only used on the camera's thread, as the next two.
  std::chrono::steady_clock::time_point last_frame_at_;
  double second_began_s_ = 0;
  std::uint64_t frames_in_second_ = 0;
  std::thread thread_;
};

}  // namespace hermite::client
