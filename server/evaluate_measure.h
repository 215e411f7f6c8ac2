// The output of `hermite evaluate --measure`: whether measurements in a result are as accurate as
// they claim.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hermite::commands {

struct MeasureJudging {
  std::string result;    // folder written by hermite reconstruct
  std::string sequence;  // with ground truth poses and noise-free depth
  std::int64_t pairs = 10'000;
  std::uint64_t seed = 1;
  std::string csv;  // file for all pairs; empty: none
};

// Measures random pairs of points (core/evaluate/true_points.h), which deviate from the surface as
// picks on a mesh do. Keys: tried, refused (share of these that could not be measured), pairs,
// inside (share of the true distances within the interval), median_half_width, median_error,
// classes (the same by true distance) and half_width_at_1m_m (median of those from 0.9 to 1.1 m).
// `kinds` has the same for the other kinds, by name and in the unit of each: as many heights, and a
// twentieth as many planes, angles and areas; up is the true one in the world frame of the result.
// Throws SetupError.
nlohmann::ordered_json evaluate_measure(const MeasureJudging& judging);

}  // namespace hermite::commands
