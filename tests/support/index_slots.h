// What an index map shows. Header only.
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/index_map.h"

namespace hermite::test {

// By pixel, kNoSurfel where there is none.
inline std::vector<std::uint32_t> slots_of(const map::IndexMap& map) {
  std::vector<std::uint32_t> slots;
  for (const shared::NearestSurfel& nearest : map.nearest().download())
    slots.push_back(nearest.slot);
  return slots;
}

}  // namespace hermite::test
