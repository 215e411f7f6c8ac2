// Describes a recording and its possible problems before time is spent on reconstructing it:
// `hermite inspect`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/dataset/recording.h"
#include "core/evaluate/depth_survey.h"
#include "core/evaluate/registration_check.h"

namespace hermite::evaluate {

struct TimeGap {
  std::int64_t after_frame = 0;
  double length_s = 0;
};

struct TruthSurvey {
  std::int64_t pose_count = 0;
  std::int64_t frames_with_pose = 0;  // with a pose at most 20 ms away
  double path_m = 0;
  double fastest_m_per_s = 0;  // between consecutive poses
};

struct Inspection {
  std::string name, format, format_reason;
  std::int64_t frame_count = 0;
  double duration_s = 0;
  // measured_rate_hz is from the median step; 0 for one frame.
  double stated_rate_hz = 0, measured_rate_hz = 0;
  std::int64_t gap_count = 0;         // steps of more than 1.5 medians
  std::vector<TimeGap> longest_gaps;  // at most 5
  std::uint64_t size_bytes = 0;       // on disk
  Camera camera;
  std::string camera_source;
  std::int64_t frames_looked_at = 0, unreadable_count = 0;
  DepthSurvey depth;
  UnitGuess unit;
  // Nullopt: depth is known to be that of another camera, or there are too few edges.
  std::optional<RegistrationFit> registration;
  TruthSurvey truth;
  // Those of the recording itself and those found by the inspection.
  std::vector<std::string> doubts;
};

// Examines the times of all frames and `max_frames` images (at least 1), spread evenly. `path` is
// the location of the recording.
Inspection inspect(const dataset::Recording& recording, const std::string& path,
                   std::int64_t max_frames = 24);

// Return the inspection as text for people, and as one JSON object.
std::string inspection_text(const Inspection& inspection);
std::string inspection_json(const Inspection& inspection);

}  // namespace hermite::evaluate
