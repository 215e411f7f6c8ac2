#include "server/store/scan_row.h"

namespace hermite::server {

const char* name_of(ScanPhase phase) {
  switch (phase) {
    case ScanPhase::kRunning: return "running";
    case ScanPhase::kFinished: return "finished";
    case ScanPhase::kFailed: return "failed";
    case ScanPhase::kInterrupted: return "interrupted";
  }
  return "unknown";
}

}  // namespace hermite::server
