// How far a running scan is: whether it takes frames, has all of them, is to end early and why, or
// has ended. It never goes back: what was to end ends. A value that belongs to one thread.
#pragma once

#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/scan/scan_worker.h"

namespace hermite::server {

enum class EndCause {
  kOther,
  kNoRoom,  // for more frames; the results still fit
};

class ScanLifecycle {
 public:
  // `has_all_frames`: an earlier server has received them.
  explicit ScanLifecycle(bool has_all_frames) : has_all_frames_(has_all_frames) {}

  // The camera has sent its last frame: results are being made.
  void all_frames_came() { has_all_frames_ = true; }

  // Each returns whether that is news to the worker, and otherwise changes nothing. A scan that has
  // all its frames does not end early.
  bool end_early(const Error& why, EndCause cause = EndCause::kOther);
  bool discard();  // also when it has all its frames

  // It is left to the next server, which continues it from its frames.
  void leave(const Error& why);

  // The worker has ended. Returns how the scan ends: as the worker says, unless it is discarded.
  // Ended as `running`, it is left to the next server.
  ScanEnd ended(ScanEnd end);

  bool takes_frames() const { return !is_ending() && !has_all_frames_; }
  bool has_all_frames() const { return has_all_frames_; }
  // Whether it is ending or has ended: of a frame that still comes nothing is made.
  bool is_ending() const { return is_over() || ending_; }
  bool is_over() const { return phase_ != wire::ScanPhase::kRunning; }
  bool is_discarded() const { return discarded_; }
  // Whether it has ended, or is ending, because there was no room for more frames or for its
  // results.
  bool lacked_room() const { return lacked_room_; }
  wire::ScanPhase phase() const { return phase_; }
  const Error& why_ending() const { return why_; }

 private:
  wire::ScanPhase phase_ = wire::ScanPhase::kRunning;
  Error why_;
  bool has_all_frames_;
  bool ending_ = false;
  bool discarded_ = false;
  bool lacked_room_ = false;
};

}  // namespace hermite::server
