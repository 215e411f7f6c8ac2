// Binary descriptors of 256 bits (ORB). Plain values, pure functions.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace hermite {

using Descriptor = std::array<std::uint64_t, 4>;
inline constexpr int kDescriptorBits = 256;

// Number of bits that differ, 0 to 256. Unrelated ORB descriptors differ in 128 bits or so, two views of one point in 20 to 60.
inline int hamming(const Descriptor& a, const Descriptor& b) {
  int bits = 0;
  for (std::size_t word = 0; word < a.size(); ++word) bits += std::popcount(a[word] ^ b[word]);
  return bits;
}

// The index of the one whose median distance to all of them is least, the earlier of equals. `descriptors` must not be empty; takes time
// quadratic in their count.
std::size_t medoid(const std::vector<Descriptor>& descriptors);

}  // namespace hermite
