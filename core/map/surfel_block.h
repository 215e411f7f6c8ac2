// A block of surfels as plain values: how it is moved between the device and the host, saved, and
// filled anew.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/map/surfel.h"
#include "shaders/shared/map.h"

namespace hermite::map {

// Identifies a block, wherever it is stored.
struct BlockName {
  std::uint32_t number = 0;
  std::uint32_t moved_frame = 0;  // the frame before which compact() filled or emptied it
};

// All arrays have kSlotsPerBlock entries.
struct SurfelBlock {
  BlockName name;
  std::vector<shared::vec4> positions;
  std::vector<shared::SurfelAttributes> attributes;
  std::vector<shared::uvec2> times;
  shared::BlockBounds bounds;
  std::uint32_t changed_frame = 0;
  std::uint32_t alive_count = 0;
  std::uint32_t submap = 0;  // of its live surfels
};

bool is_alive(const shared::vec4& position_confidence);

// Returns a block without surfels, changed when it was moved.
SurfelBlock empty_block(const BlockName& name);

// Sets alive_count and submap from the surfels.
void describe(SurfelBlock& block);

// Returns all slots, including free ones.
std::vector<Surfel> surfels_of(const SurfelBlock& block);

// Returns the live surfels of these blocks in the smallest possible number of new blocks, those of
// a submap together and neighbours beside each other. The new blocks have moved at `frame_number`;
// their numbers are 0.
std::vector<SurfelBlock> regrouped(const std::vector<SurfelBlock>& sparse,
                                   std::uint32_t frame_number);

// restore() fails the reader if an array is too short or long, or a surfel is impossible.
void save(ByteWriter& bytes, const SurfelBlock& block);
void restore(ByteReader& bytes, SurfelBlock& block, std::size_t submap_count);

// Fails the reader unless all positions are finite, and all live surfels are of one of the submaps.
// The arrays have equal lengths.
void check_surfels(ByteReader& bytes, std::span<const shared::vec4> positions,
                   std::span<const shared::SurfelAttributes> attributes, std::size_t submap_count);

}  // namespace hermite::map
