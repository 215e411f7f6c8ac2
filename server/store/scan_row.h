// A scan as a row of the store. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/math/camera.h"

namespace hermite::server {

// More tags than a person gives a scan, and longer ones; together at most a kilobyte.
inline constexpr std::size_t kMaxTagsPerScan = 20, kMaxTagBytes = 50;

enum class ScanPhase { kRunning, kFinished, kFailed, kInterrupted };
const char* name_of(ScanPhase phase);  // "running", "finished", "failed", "interrupted"

struct ScanRow {
  std::string id;
  std::string title;
  std::vector<std::string> tags;  // UTF-8 without line ends, sorted, each once
  ScanPhase phase = ScanPhase::kRunning;
  std::string message;  // why it failed or was interrupted
  // Id of the token that owns it; empty: unknown, for scans of older servers.
  std::string token_id;
  // It has ended and its frames exist, but its results could not be stored.
  bool to_be_rebuilt = false;
  Camera camera;
  std::int64_t frames_received = 0;
  std::int64_t frames_processed = 0;
  std::int64_t frames_dropped = 0;
  std::int64_t created_at_ms = 0;   // Unix time
  std::int64_t finished_at_ms = 0;  // 0 while running
};

// What people call a scan; std::nullopt: as it is.
struct ScanLabels {
  std::optional<std::string> title;
  std::optional<std::vector<std::string>> tags;
};

}  // namespace hermite::server
