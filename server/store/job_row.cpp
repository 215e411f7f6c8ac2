#include "server/store/job_row.h"

namespace hermite::server {

const char* name_of(JobState state) {
  switch (state) {
    case JobState::kQueued: return "queued";
    case JobState::kRunning: return "running";
    case JobState::kFinished: return "finished";
    case JobState::kFailed: return "failed";
    case JobState::kCancelled: return "cancelled";
  }
  return "unknown";
}

bool has_ended(JobState state) { return state != JobState::kQueued && state != JobState::kRunning; }

const char* name_of(JobSource source) { return source == JobSource::kUpload ? "upload" : "scan"; }

}  // namespace hermite::server
