// The output of `hermite evaluate` about a trajectory: beside ground truth, and beside the depth
// images of its sequence.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/dataset/trajectory.h"
#include "core/evaluate/depth_consistency.h"

namespace hermite::commands {

struct TrajectoryJudging {
  std::string estimate;     // TUM file
  std::string groundtruth;  // read_groundtruth(); empty: that of the sequence
  std::string per_frame;    // CSV file for the errors of each frame; empty: none
  std::string consistency;  // sequence whose depth images are compared
  std::vector<std::int64_t> spacings = evaluate::ConsistencyOptions().spacings;
};

// Returns the true poses of a TUM file or of a sequence. Throws SetupError, also if it has none.
dataset::Trajectory read_groundtruth(const std::string& source);

// Compares the estimate with the ground truth, and writes the errors of each frame. Throws
// SetupError.
nlohmann::ordered_json evaluate_trajectory(const TrajectoryJudging& judging);

// Says how well the depth images agree under the estimate, and under the ground truth where there
// is one. Throws SetupError.
nlohmann::ordered_json evaluate_consistency(const TrajectoryJudging& judging);

}  // namespace hermite::commands
