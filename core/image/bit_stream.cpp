#include "core/image/bit_stream.h"

#include <bit>

#include "core/base/check.h"

namespace hermite::image {
namespace {

constexpr int kMaxGammaBits = 20;

}  // namespace

void BitWriter::put(std::uint32_t value, int count) {
  CHECK(count >= 0 && count <= 32, "a number of 0 to 32 bits");
  held_ |= (value & ((std::uint64_t{1} << count) - 1)) << held_count_;
  for (held_count_ += count; held_count_ >= 8; held_count_ -= 8) {
    bytes_.push_back(static_cast<std::uint8_t>(held_));
    held_ >>= 8;
  }
}

void BitWriter::put_gamma(std::uint32_t value) {
  CHECK(value >= 1 && value < (1u << kMaxGammaBits), "a gamma code of " + std::to_string(value));
  const int low_bits = static_cast<int>(std::bit_width(value)) - 1;
  put(1u << low_bits, low_bits + 1);  // as many zeros as low bits follow, then a one
  put(value, low_bits);
}

std::vector<std::uint8_t> BitWriter::finish() && {
  if (held_count_ > 0) bytes_.push_back(static_cast<std::uint8_t>(held_));
  return std::move(bytes_);
}

std::uint32_t BitReader::get(int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) {
    if (next_bit_ == 8 * bytes_.size()) {
      cut_ = true;
      return value;
    }
    value |= static_cast<std::uint32_t>((bytes_[next_bit_ / 8] >> (next_bit_ % 8)) & 1) << i;
    ++next_bit_;
  }
  return value;
}

std::uint32_t BitReader::get_gamma() {
  int low_bits = 0;
  while (get(1) == 0) {
    if (cut_ || ++low_bits == kMaxGammaBits) return 0;
  }
  return (1u << low_bits) | get(low_bits);
}

bool BitReader::padding_is_zero() const {
  return next_bit_ % 8 == 0 || (bytes_[next_bit_ / 8] >> (next_bit_ % 8)) == 0;
}

}  // namespace hermite::image
