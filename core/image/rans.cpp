#include "core/image/rans.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "core/base/check.h"

namespace hermite::image {

static_assert(std::endian::native == std::endian::little, "words are copied as they lie in memory");

std::vector<std::uint16_t> scale_frequencies(std::span<const std::uint32_t> counts) {
  CHECK(counts.size() <= static_cast<std::size_t>(kMaxRansSymbols), "too many symbols");
  const std::uint64_t count_sum = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  CHECK(count_sum > 0, "frequencies of nothing");
  std::vector<std::uint16_t> frequencies(counts.size());
  std::int64_t missing = kFrequencySum;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const std::uint64_t share =
        (std::uint64_t{counts[i]} * kFrequencySum + count_sum / 2) / count_sum;
    frequencies[i] = static_cast<std::uint16_t>(std::max<std::uint64_t>(share, 1));
    missing -= frequencies[i];
  }
  // Rounding hurts the most frequent symbol least. With at most 128 symbols of 1 too many it keeps
  // more than 1.
  while (missing != 0) {
    std::uint16_t& largest = *std::max_element(frequencies.begin(), frequencies.end());
    const std::int64_t change = std::max<std::int64_t>(missing, 1 - std::int64_t{largest});
    largest = static_cast<std::uint16_t>(largest + change);
    missing -= change;
  }
  return frequencies;
}

void fill_shares(std::span<const std::uint16_t> frequencies, std::span<RansShare> shares) {
  CHECK(shares.size() >= frequencies.size(), "more frequencies than shares");
  std::uint32_t start = 0;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const std::uint32_t frequency = frequencies[i];
    if (frequency == 0) continue;
    // With 2^shift >= 2^31 * frequency the rounding up adds less than 1 / frequency to any
    // quotient.
    const int shift = 31 + static_cast<int>(std::bit_width(frequency - 1));
    shares[i] = {
        static_cast<std::uint32_t>(((std::uint64_t{1} << shift) + frequency - 1) / frequency),
        static_cast<std::uint8_t>(shift), frequencies[i], static_cast<std::uint16_t>(start)};
    start += frequency;
  }
  CHECK(start == kFrequencySum, "frequencies sum up to " + std::to_string(start));
}

void fill_slots(std::span<const std::uint16_t> frequencies, RansSlots& slots) {
  std::uint32_t slot = 0;
  for (std::size_t symbol = 0; symbol < frequencies.size(); ++symbol) {
    const std::uint32_t frequency = frequencies[symbol];
    CHECK(slot + frequency <= kFrequencySum, "frequencies sum up to more than their limit");
    const std::uint32_t constant = static_cast<std::uint32_t>(symbol + 1) | ((frequency - 1) << 8);
    for (std::uint32_t place = 0; place < frequency; ++place)
      slots[slot++] = constant | (place << 20);
  }
  CHECK(slot == kFrequencySum, "frequencies sum up to " + std::to_string(slot));
}

void RansEncoder::finish(std::vector<std::uint8_t>& bytes) && {
  // Read backwards: the high word of lane 0 first.
  for (std::size_t lane = kRansLanes; lane-- > 0;) {
    words_.push_back(static_cast<std::uint16_t>(states_[lane]));
    words_.push_back(static_cast<std::uint16_t>(states_[lane] >> 16));
  }
  const std::size_t header_bytes = bytes.size();
  bytes.resize(header_bytes + words_.size() * sizeof(std::uint16_t));
  std::memcpy(bytes.data() + header_bytes, words_.data(), words_.size() * sizeof(std::uint16_t));
}

RansDecoder::RansDecoder(std::span<const std::uint8_t> bytes)
    : bytes_(bytes), left_bytes_(bytes.size()) {
  for (std::uint32_t& state : states_) {
    const std::uint32_t high = next_word();
    state = (high << 16) | next_word();
    cut_ = cut_ || state < kRansLowest || state >= (kRansLowest << 16);
  }
}

bool RansDecoder::at_end() const {
  return !cut_ && left_bytes_ == 0 &&
         std::all_of(states_.begin(), states_.end(),
                     [](std::uint32_t state) { return state == kRansLowest; });
}

}  // namespace hermite::image
