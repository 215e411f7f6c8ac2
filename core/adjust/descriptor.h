// Binary descriptors of 256 bits (ORB). Plain values, pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hermite {

using Descriptor = std::array<std::uint64_t, 4>;
inline constexpr int kDescriptorBits = 256;

// Number of bits that differ, 0 to 256. Unrelated ORB descriptors differ in 128 bits or so, two views of one point in 20 to 60.
// std::popcount is a call of the library's on processors of the base kind and takes four times as long (14 against 3.6 ns): here the four
// words are counted together, first in pairs of bits, then in fours, in bytes (32 at most) and in 16 bits.
inline int hamming(const Descriptor& a, const Descriptor& b) {
  constexpr std::uint64_t kPairs = 0x5555555555555555, kFours = 0x3333333333333333, kBytes = 0x0f0f0f0f0f0f0f0f;
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

// The index of the one whose median distance to all of them is least, the earlier of equals. `descriptors` must not be empty; takes time
// quadratic in their count.
std::size_t medoid(const std::vector<Descriptor>& descriptors);

}  // namespace hermite
