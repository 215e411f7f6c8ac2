// A scan as a row of the store. Plain values.
#pragma once

#include <cstdint>
#include <string>

#include "core/math/camera.h"

namespace hermite {

enum class ScanPhase { kRunning, kFinished, kFailed, kInterrupted };
const char* name_of(ScanPhase phase);  // "running", "finished", "failed", "interrupted"

struct ScanRow {
  std::string id;
  std::string title;
  ScanPhase phase = ScanPhase::kRunning;
  std::string message;         // why it failed or was interrupted
  std::string token_id;        // of the token that owns it; empty: unknown, for scans of older servers
  bool to_be_rebuilt = false;  // it has ended and its frames exist, but its results could not be stored
  Camera camera;
  std::int64_t frames_received = 0;
  std::int64_t frames_processed = 0;
  std::int64_t frames_dropped = 0;
  std::int64_t created_at_ms = 0;   // Unix time
  std::int64_t finished_at_ms = 0;  // 0 while running
};

}  // namespace hermite
