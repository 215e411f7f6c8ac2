// Small numbers in few bits, lowest bit of a byte first: the headers of our own formats. Values;
// single-threaded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace hermite::image {

class BitWriter {
 public:
  // The lowest `count` bits of `value`, 0 to 32.
  void put(std::uint32_t value, int count);
  // Elias gamma: 1 in one bit, 2 and 3 in three, 4 to 7 in five, ... `value` is at least 1 (CHECK).
  void put_gamma(std::uint32_t value);
  // The last byte is filled with zeros.
  std::vector<std::uint8_t> finish() &&;

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t held_ = 0;
  int held_count_ = 0;  // 0 to 7 between calls
};

// Behind the end it reads zeros and is `cut`: a reader may ask once, after the last number. Never
// reads out of bounds.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint32_t get(int count);  // 0 to 32
  // 1 to 2^20 - 1, more than any number here; 0 when what is there is no gamma code of such a
  // number.
  std::uint32_t get_gamma();
  bool cut() const { return cut_; }

  // The bytes behind the last one touched. `padding_is_zero` says whether what was left of that one
  // is zeros.
  std::span<const std::uint8_t> rest() const { return bytes_.subspan((next_bit_ + 7) / 8); }
  bool padding_is_zero() const;

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t next_bit_ = 0;  // at most 8 * bytes_.size()
  bool cut_ = false;
};

}  // namespace hermite::image
