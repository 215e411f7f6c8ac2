// A job as a row of the store: a recording, or the frames of a scan, to be processed into a scan.
// Plain values.
#pragma once

#include <cstdint>
#include <string>

namespace hermite::server {

enum class JobState { kQueued, kRunning, kFinished, kFailed, kCancelled };
inline constexpr JobState kAllJobStates[] = {JobState::kQueued, JobState::kRunning,
                                             JobState::kFinished, JobState::kFailed,
                                             JobState::kCancelled};
const char* name_of(JobState state);  // "queued", "running", "finished", "failed", "cancelled"
bool has_ended(JobState state);

enum class JobSource { kUpload, kScan };
const char* name_of(JobSource source);  // "upload", "scan"

// Jobs of higher priority run first.
inline constexpr int kLowestPriority = -100, kHighestPriority = 100;
// Higher ones are for administrators.
inline constexpr int kHighestPriorityForAll = 0;

struct JobRow {
  std::string id;  // the same as the upload's for the job of an upload
  std::string token_id;
  std::string title;
  JobSource source = JobSource::kUpload;
  std::string source_id;        // id of the upload or scan
  std::string settings = "{}";  // JSON object of strings, as for a camera
  std::string camera;           // as in camera.json; empty: the recording's own
  int priority = 0;
  JobState state = JobState::kQueued;
  std::string message;  // why it failed, or remarks about the scan
  // Number of starts; more than one if a server ended while it ran.
  int attempt_count = 0;
  std::string scan_id;              // of the scan that it makes; empty before the first start
  std::int64_t created_at_ms = 0;   // Unix time
  std::int64_t started_at_ms = 0;   // 0: not started
  std::int64_t finished_at_ms = 0;  // 0: not ended
};

struct JobLine {
  std::int64_t at_ms = 0;
  std::string message;
};

}  // namespace hermite::server
