// The depths that occur in a frame, so that a depth can be sent as its rank among them. Pure
// functions; for depth_ranks.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/image/bit_stream.h"

namespace hermite::image {

inline constexpr int kMaxRank = 65535;

// value_of[rank], ascending from value_of[0] = 0 for an invalid pixel; empty when ranks are the
// values themselves.
using RankDictionary = std::vector<std::uint16_t>;

int highest_rank(const RankDictionary& dictionary);

// Every value of `pixels`; empty when the values lie so densely that the dictionary would cost more
// bits than it saves.
RankDictionary find_rank_dictionary(std::span<const std::uint16_t> pixels);

// rank_of[value] for all 65536 values; those not in the dictionary have 0.
std::vector<std::uint16_t> ranks_by_value(const RankDictionary& dictionary);

void write_rank_dictionary(const RankDictionary& dictionary, BitWriter& header);
// kCorruptData with a message. Takes memory for 65536 values at most.
Result<RankDictionary> read_rank_dictionary(BitReader& header);

}  // namespace hermite::image
