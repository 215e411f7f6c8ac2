// Random numbers from a key and a counter: they need no state, so frames can be read in any order
// by any thread. Header only.
#pragma once

#include <cmath>
#include <cstdint>

namespace hermite {

// The finaliser of splitmix64: turns counters into independent bits.
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

inline std::uint64_t frame_key(std::uint64_t seed, std::int64_t frame_index) {
  return mix_bits(mix_bits(seed) + static_cast<std::uint64_t>(frame_index));
}

// Returns a number from 0 inclusive to 1 exclusive.
inline double unit_uniform(std::uint64_t key, std::uint64_t counter) {
  return static_cast<double>(mix_bits(key ^ mix_bits(counter)) >> 11) * 0x1p-53;
}

// Two independent standard normal numbers by the Box-Muller method; the first uniform is in (0, 1]
// so that its logarithm is finite.
struct NormalPair {
  double a, b;
};
inline NormalPair normal_pair(std::uint64_t key, std::uint64_t counter) {
  const std::uint64_t bits = mix_bits(key ^ mix_bits(counter));
  const double uniform = (static_cast<double>(bits >> 32) + 1.0) * 0x1p-32;
  const double angle = static_cast<double>(bits & 0xffffffffu) * (2.0 * M_PI * 0x1p-32);
  const double radius = std::sqrt(-2.0 * std::log(uniform));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace hermite
