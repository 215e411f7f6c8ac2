#include "core/mesh/surfel_grid.h"

#include <algorithm>

#include "core/base/check.h"

namespace hermite::mesh {

// Bin indices have less than 20 bits, since SurfelField limits cell indices to that.
std::uint64_t SurfelGrid::key_of(const Eigen::Vector3i& bin) {
  const auto part = [](int value) { return static_cast<std::uint64_t>(value + (1 << 20)); };
  return part(bin.z()) << 42 | part(bin.y()) << 21 | part(bin.x());
}

void SurfelGrid::insert(std::uint32_t slot, const Eigen::Vector3f& position_m) {
  std::vector<std::uint32_t>& slots = slots_by_bin_[key_of(bin_of(position_m))];
  slots.insert(std::lower_bound(slots.begin(), slots.end(), slot), slot);
}

void SurfelGrid::remove(std::uint32_t slot, const Eigen::Vector3f& position_m) {
  const auto bin = slots_by_bin_.find(key_of(bin_of(position_m)));
  CHECK(bin != slots_by_bin_.end(), "a surfel of no bin");
  const auto place = std::lower_bound(bin->second.begin(), bin->second.end(), slot);
  CHECK(place != bin->second.end() && *place == slot, "a surfel that is not in its bin");
  bin->second.erase(place);
  if (bin->second.empty()) slots_by_bin_.erase(bin);
}

}  // namespace hermite::mesh
