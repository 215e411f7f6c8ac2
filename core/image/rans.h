// An entropy coder: asymmetric numeral systems with ranges (rANS, Duda 2013; Giesen's way with
// 16-bit words), for symbols whose frequencies both ends know beforehand. Integers only: the same
// bytes on every machine.
//
// Several coders ("lanes") take turns on one sequence of words, so that a processor can work on
// symbols that do not wait for each other. What is decoded first must be encoded last. Words are
// written forwards and read backwards, so that a header can stand before them and needs to state no
// length. Values; single-threaded.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace hermite::image {

// With 12 a Kinect's depth is 0.1 % smaller, but the decoder's tables fall out of the L1 cache.
inline constexpr int kFrequencyBits = 11;
// Sum of all frequencies that belong together.
inline constexpr std::uint32_t kFrequencySum = 1u << kFrequencyBits;
inline constexpr int kMaxRansSymbols = 128;
inline constexpr int kRansLanes = 2;

// Frequencies proportional to `counts` (at most kMaxRansSymbols of them, their sum 1 to 2^32): 0
// for 0, at least 1 for the others; the sum is kFrequencySum.
std::vector<std::uint16_t> scale_frequencies(std::span<const std::uint32_t> counts);

// A symbol's share of the numbers below kFrequencySum, for the encoder.
struct RansShare {
  // 2^shift / frequency, rounded up: dividing by multiplication is exact below 2^31.
  std::uint32_t reciprocal = 0;
  std::uint8_t shift = 0;
  std::uint16_t frequency = 0;
  std::uint16_t start = 0;
};
// `frequencies` sum up to kFrequencySum (CHECK); of a symbol with frequency 0 the share stays as it
// is.
void fill_shares(std::span<const std::uint16_t> frequencies, std::span<RansShare> shares);

// What a decoder returns for a number that belongs to no symbol.
inline constexpr std::uint32_t kNoRansSymbol = 0xffffffff;

// The same for the decoder: for every number below kFrequencySum the symbol + 1 (8 bits), its
// frequency - 1 (12 bits) and the number's place in the symbol's share (12 bits). A slot of zeros
// has no symbol: what is not filled decodes to kNoRansSymbol.
using RansSlots = std::array<std::uint32_t, kFrequencySum>;
void fill_slots(std::span<const std::uint16_t> frequencies, RansSlots& slots);

// A state is 2^15 to 2^31 - 1; 16 bits move at a time.
inline constexpr std::uint32_t kRansLowest = 1u << 15;

class RansEncoder {
 public:
  RansEncoder() { states_.fill(kRansLowest); }

  void put(int lane, const RansShare& share) {
    std::uint32_t& state = make_room(lane, std::uint64_t{share.frequency} << (31 - kFrequencyBits));
    const auto quotient =
        static_cast<std::uint32_t>((std::uint64_t{state} * share.reciprocal) >> share.shift);
    state = (quotient << kFrequencyBits) + (state - quotient * share.frequency) + share.start;
  }
  // The lowest `count` bits of `value`, 0 to 15, as likely one way as the other.
  void put_bits(int lane, std::uint32_t value, int count) {
    std::uint32_t& state = make_room(lane, std::uint64_t{1} << (31 - count));
    state = (state << count) | value;
  }
  // Appends the words, the last encoded at the end.
  void finish(std::vector<std::uint8_t>& bytes) &&;

 private:
  std::uint32_t& make_room(int lane, std::uint64_t limit) {
    std::uint32_t& state = states_[static_cast<std::size_t>(lane)];
    if (state >= limit) {
      words_.push_back(static_cast<std::uint16_t>(state));
      state >>= 16;
    }
    return state;
  }

  std::array<std::uint32_t, kRansLanes> states_;
  std::vector<std::uint16_t> words_;
};

// Whatever the bytes, decodes without reading out of bounds; at_end() after the last symbol says
// whether they can have been encoded.
class RansDecoder {
 public:
  explicit RansDecoder(std::span<const std::uint8_t> bytes);

  std::uint32_t get(int lane, const RansSlots& slots) {
    std::uint32_t& state = states_[static_cast<std::size_t>(lane)];
    const std::uint32_t slot = slots[state & (kFrequencySum - 1)];
    state = (state >> kFrequencyBits) * (((slot >> 8) & (kFrequencySum - 1)) + 1) + (slot >> 20);
    refill(state);
    return (slot & 0xffu) - 1;
  }
  std::uint32_t get_bits(int lane, int count) {
    std::uint32_t& state = states_[static_cast<std::size_t>(lane)];
    const std::uint32_t value = state & ((1u << count) - 1);
    state >>= count;
    refill(state);
    return value;
  }
  // Every word was used, none was missing, and the states are those that an encoder starts from.
  bool at_end() const;

 private:
  void refill(std::uint32_t& state) {
    if (state < kRansLowest) state = (state << 16) | next_word();
  }
  std::uint32_t next_word() {
    std::uint16_t word = 0;
    if (left_bytes_ < sizeof(word)) {
      cut_ = true;
      return 0;
    }
    left_bytes_ -= sizeof(word);
    std::memcpy(&word, bytes_.data() + left_bytes_, sizeof(word));
    return word;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t left_bytes_;
  std::array<std::uint32_t, kRansLanes> states_;
  bool cut_ = false;
};

}  // namespace hermite::image
