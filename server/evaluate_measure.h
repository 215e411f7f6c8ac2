// What `hermite evaluate --measure` prints: whether what is measured in a result lies as near to the truth as is said of it.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hermite {

struct MeasureJudging {
  std::string result;    // folder as hermite reconstruct writes it
  std::string sequence;  // with true poses and depth without noise
  std::int64_t pairs = 10'000;
  std::uint64_t seed = 1;
  std::string csv;  // every pair goes there; empty: nowhere
};

// Of random pairs of points (core/evaluate/true_points.h), whose picks lie off the surface as those on a mesh do. Keys: tried, refused
// (share of these that could not be measured), pairs, inside (share of the true distances within the interval), median_half_width,
// median_error, classes (the same by the true distance) and half_width_at_1m_m (median of those from 0.9 to 1.1 m). In kinds the same of
// the other kinds, by name and in the unit of each: as many heights, and planes, angles and areas a twentieth as many; up is the true one
// in the world of the result. SetupError.
nlohmann::ordered_json evaluate_measure(const MeasureJudging& judging);

}  // namespace hermite
