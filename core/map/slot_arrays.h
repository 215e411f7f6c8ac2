// The arrays of consecutive blocks of slots on the host, laid out as in a SurfelStore: what is
// moved to and from the device, and saved.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/map/surfel.h"
#include "core/map/surfel_block.h"
#include "shaders/shared/map.h"

namespace hermite::map {

struct SlotArrays {
  // By slot.
  std::vector<shared::vec4> positions;
  std::vector<shared::SurfelAttributes> attributes;
  std::vector<shared::uvec2> times;
  // By block.
  std::vector<shared::BlockBounds> bounds;
  std::vector<shared::uint> changed_frames;
};

// All slots of `count` blocks, free.
SlotArrays free_arrays(std::uint32_t count);

// The last block has only the slots of the surfels that are left for it.
SlotArrays arrays_of(std::span<const Surfel> surfels);

SlotArrays arrays_of(std::span<const SurfelBlock> blocks);

// Returns the block at this place in the arrays.
SurfelBlock block_at(const SlotArrays& arrays, std::uint32_t place, const BlockName& name);

// All slots as they are between frames.
struct SavedSlots {
  shared::MapState state{};
  SlotArrays arrays;
  std::vector<shared::uint> free_slots;
};

// Fails the reader unless the parts agree with each other and with the number of submaps, so that
// no pass can leave its arrays.
void check_slots(ByteReader& bytes, const SavedSlots& saved, std::size_t submap_count);

}  // namespace hermite::map
