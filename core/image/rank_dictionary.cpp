#include "core/image/rank_dictionary.h"

#include <fmt/core.h>

#include <bit>
#include <string>

#include "core/image/corrupt_depth.h"

namespace hermite::image {
namespace {

std::uint64_t gamma_bits(std::uint32_t value) {
  return 2 * static_cast<std::uint64_t>(std::bit_width(value)) - 1;
}

}  // namespace

int highest_rank(const RankDictionary& dictionary) {
  return dictionary.empty() ? kMaxRank : static_cast<int>(dictionary.size()) - 1;
}

RankDictionary find_rank_dictionary(std::span<const std::uint16_t> pixels) {
  std::vector<std::uint8_t> seen(kMaxRank + 1);
  for (const std::uint16_t pixel : pixels) seen[pixel] = 1;
  RankDictionary dictionary{0};
  std::uint64_t header_bits = 0;
  for (std::uint32_t value = 1; value <= kMaxRank; ++value) {
    if (seen[value] == 0) continue;
    header_bits += gamma_bits(value - dictionary.back());
    dictionary.push_back(static_cast<std::uint16_t>(value));
  }
  const std::uint64_t count = dictionary.size() - 1;
  if (count == 0) return dictionary;
  // A pixel's error shrinks by log2(range / count) bits, which is more than 1 - count / range.
  const std::uint64_t range = std::uint64_t{dictionary.back()} - dictionary[1] + 1;
  return pixels.size() * (range - count) > header_bits * range ? dictionary : RankDictionary{};
}

std::vector<std::uint16_t> ranks_by_value(const RankDictionary& dictionary) {
  std::vector<std::uint16_t> rank_of(kMaxRank + 1);
  for (int rank = 1; rank <= highest_rank(dictionary); ++rank) {
    const auto index = static_cast<std::size_t>(rank);
    rank_of[dictionary.empty() ? index : dictionary[index]] = static_cast<std::uint16_t>(rank);
  }
  return rank_of;
}

void write_rank_dictionary(const RankDictionary& dictionary, BitWriter& header) {
  header.put(dictionary.empty() ? 0 : 1, 1);
  if (dictionary.empty()) return;
  header.put_gamma(static_cast<std::uint32_t>(dictionary.size()));
  for (std::size_t rank = 1; rank < dictionary.size(); ++rank)
    header.put_gamma(static_cast<std::uint32_t>(dictionary[rank] - dictionary[rank - 1]));
}

Result<RankDictionary> read_rank_dictionary(BitReader& header) {
  if (header.get(1) == 0) return RankDictionary{};
  const std::uint32_t size = header.get_gamma();
  if (size == 0 || size > kMaxRank + 1) return corrupt_depth("the dictionary has no valid size");
  RankDictionary dictionary{0};
  while (dictionary.size() < size) {
    const std::uint32_t step = header.get_gamma();
    if (step == 0 || dictionary.back() + step > kMaxRank) {
      return corrupt_depth(
          fmt::format("value {} of {} in the dictionary is no depth", dictionary.size(), size - 1));
    }
    dictionary.push_back(static_cast<std::uint16_t>(dictionary.back() + step));
  }
  return dictionary;
}

}  // namespace hermite::image
