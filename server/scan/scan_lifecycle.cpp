#include "server/scan/scan_lifecycle.h"

#include <utility>

namespace hermite::server {

namespace {

constexpr const char* kDiscarded = "discarded by its camera";

}  // namespace

bool ScanLifecycle::end_early(const Error& why, EndCause cause) {
  if (!takes_frames()) return false;
  leave(why);
  lacked_room_ = cause == EndCause::kNoRoom;
  return true;
}

bool ScanLifecycle::discard() {
  if (is_ending()) return false;
  leave({ErrorCode::kNotFound, kDiscarded});
  discarded_ = true;
  return true;
}

void ScanLifecycle::leave(const Error& why) {
  ending_ = true;
  why_ = why;
}

ScanEnd ScanLifecycle::ended(ScanEnd end) {
  if (discarded_)
    end = {wire::ScanPhase::kInterrupted, {ErrorCode::kNotFound, kDiscarded}, {}, kDiscarded, true};
  ending_ = true;
  phase_ = end.phase;
  lacked_room_ = lacked_room_ || end.results_missing;
  return end;
}

}  // namespace hermite::server
