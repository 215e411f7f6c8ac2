// How fast the camera moves, and how often it gives a frame: needed for frames whose own images do
// not show how it has moved.
//
// One thread at a time.
#pragma once

#include <optional>

#include "core/base/byte_stream.h"
#include "core/math/coasted_motion.h"
#include "core/math/rigid3.h"

namespace hermite::pipeline {

class CameraPace {
 public:
  // Counts the time from the frame before to this one, whether it is tracked or not.
  void count_interval(double interval_s, bool is_first);

  // Notes a tracked frame, and the motion last_from_camera since the last tracked one; nullopt if
  // it is not known.
  void step(double timestamp_s, const std::optional<Rigid3>& last_from_camera);

  double last_tracked_s() const { return last_tracked_s_; }  // timestamp of the last tracked frame

  // Returns the mean velocity between the last two tracked frames as a twist per second in the
  // camera's frame, as for exp_se3; zero if unknown.
  const Vector6d& twist_per_s() const { return last_twist_per_s_; }

  // Returns the time from the last tracked frame to `timestamp_s`, without what is usual between
  // two frames; at least 0.
  double unseen_s(double timestamp_s) const;

  // Returns the motion since the last tracked frame if the camera goes on as it went.
  CoastedMotion coasted(double timestamp_s) const {
    return coasted_motion(last_twist_per_s_, timestamp_s - last_tracked_s_);
  }

  // The state in a checkpoint, both ways; after reading, is_valid() must hold.
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved) {
    bytes.number(saved.last_tracked_s_);
    bytes.number(saved.usual_interval_s_);
    bytes.numbers(saved.last_twist_per_s_.data(), 6);
  }
  bool is_valid() const;

 private:
  double last_tracked_s_ = 0;
  double usual_interval_s_ = 0;
  // Mean between the last two tracked frames; zero if unknown.
  Vector6d last_twist_per_s_ = Vector6d::Zero();
};

}  // namespace hermite::pipeline
