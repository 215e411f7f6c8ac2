// Serialises the links of submaps in our own byte format (core/base/byte_stream.h), and checks the
// indices in a saved state.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/adjust/submap_graph.h"
#include "core/math/rigid3_fields.h"

namespace hermite::adjust {

// No frame or keyframe index is this large; sums of allowed values do not overflow.
inline constexpr std::int64_t kMaxStoredIndex = std::int64_t{1} << 40;

inline bool is_stored_index(std::int64_t index) {
  return index >= -kMaxStoredIndex && index <= kMaxStoredIndex;
}

inline bool all_below(const std::vector<std::uint32_t>& indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::uint32_t index) { return index < count; });
}

template <class Bytes, class Saved>
void link_fields(Bytes& bytes, Saved& link) {
  bytes.number(link.from);
  bytes.number(link.to);
  rigid3_fields(bytes, link.from_from_to);
  bytes.number(link.length_m);
  bytes.flag(link.is_loop);
  bytes.require(link.length_m >= 0 && std::isfinite(link.length_m),
                "the length of a link is out of range");
}

}  // namespace hermite::adjust
