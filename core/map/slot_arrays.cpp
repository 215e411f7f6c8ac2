#include "core/map/slot_arrays.h"

#include <algorithm>
#include <cstddef>

namespace hermite::map {

SlotArrays free_arrays(std::uint32_t count) {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock;
  return {std::vector<shared::vec4>(slots), std::vector<shared::SurfelAttributes>(slots),
          std::vector<shared::uvec2>(slots), std::vector<shared::BlockBounds>(count),
          std::vector<shared::uint>(count)};
}

SlotArrays arrays_of(std::span<const Surfel> surfels) {
  SlotArrays arrays;
  for (const Surfel& s : surfels) {
    arrays.positions.push_back({s.position_in_submap_m.x(), s.position_in_submap_m.y(),
                                s.position_in_submap_m.z(), s.confidence});
    arrays.attributes.push_back(pack_attributes(s));
    arrays.times.push_back({s.created_frame, s.observed_frame});
  }
  arrays.bounds = bounds_of(surfels);
  arrays.changed_frames.assign(arrays.bounds.size(), 0);
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    shared::uint& changed = arrays.changed_frames[i / kSlotsPerBlock];
    changed = std::max(changed, surfels[i].observed_frame);
  }
  return arrays;
}

SlotArrays arrays_of(std::span<const SurfelBlock> blocks) {
  SlotArrays arrays;
  for (const SurfelBlock& block : blocks) {
    arrays.positions.insert(arrays.positions.end(), block.positions.begin(), block.positions.end());
    arrays.attributes.insert(arrays.attributes.end(), block.attributes.begin(),
                             block.attributes.end());
    arrays.times.insert(arrays.times.end(), block.times.begin(), block.times.end());
    arrays.bounds.push_back(block.bounds);
    arrays.changed_frames.push_back(block.changed_frame);
  }
  return arrays;
}

SurfelBlock block_at(const SlotArrays& arrays, std::uint32_t place, const BlockName& name) {
  const auto begin = static_cast<std::ptrdiff_t>(std::size_t{place} * kSlotsPerBlock),
             end = begin + static_cast<std::ptrdiff_t>(kSlotsPerBlock);
  SurfelBlock block{name,
                    {arrays.positions.begin() + begin, arrays.positions.begin() + end},
                    {arrays.attributes.begin() + begin, arrays.attributes.begin() + end},
                    {arrays.times.begin() + begin, arrays.times.begin() + end},
                    arrays.bounds[place],
                    arrays.changed_frames[place]};
  describe(block);
  return block;
}

void check_slots(ByteReader& bytes, const SavedSlots& saved, std::size_t submap_count) {
  const shared::MapState& state = saved.state;
  const SlotArrays& arrays = saved.arrays;
  const std::size_t blocks = arrays.bounds.size(), slots = arrays.positions.size();
  bytes.require(blocks == (std::size_t{state.slot_count} + kSlotsPerBlock - 1) / kSlotsPerBlock &&
                    slots == blocks * kSlotsPerBlock && arrays.attributes.size() == slots &&
                    arrays.times.size() == slots && arrays.changed_frames.size() == blocks,
                "the arrays have different lengths");
  if (!bytes.ok()) return;
  check_surfels(bytes, arrays.positions, arrays.attributes, submap_count);
  bytes.require(state.alive_count <= state.slot_count, "the number of surfels is out of range");
  bytes.require(state.new_count == 0 && state.fresh_count == 0 && state.freed_count == 0,
                "the counters are from within a frame");
  bytes.require(state.free_count == saved.free_slots.size(),
                "the number of free slots is inconsistent");
  std::vector<bool> is_listed(slots, false);
  for (const shared::uint slot : saved.free_slots) {
    const bool right =
        slot < state.slot_count && !is_listed[slot] && !is_alive(arrays.positions[slot]);
    bytes.require(right, "a free slot is in use, out of range or listed twice");
    if (right) is_listed[slot] = true;
  }
  for (const shared::ZoneSlots& zone : state.zones)
    bytes.require(zone.free_count == 0 || (zone.free_begin <= state.free_count &&
                                           zone.free_count <= state.free_count - zone.free_begin),
                  "the free slots of a zone are out of range");
}

}  // namespace hermite::map
