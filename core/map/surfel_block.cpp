#include "core/map/surfel_block.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hermite::map {

namespace {

// Returns the position's index along a Morton curve through cells of 2 cm, which keeps neighbours
// together.
std::uint32_t cell_of(const shared::vec4& position) {
  constexpr float kCell_m = 0.02f;
  constexpr int kBits = 10;  // an axis: 20 m around the submap's origin
  std::uint32_t cell = 0;
  int axis = 0;
  for (const float p_m : {position.x, position.y, position.z}) {
    const float at =
        std::clamp(p_m / kCell_m + float{1 << (kBits - 1)}, 0.0f, float{(1 << kBits) - 1});
    const auto index = static_cast<std::uint32_t>(at);
    for (int bit = 0; bit < kBits; ++bit) cell |= ((index >> bit) & 1u) << (3 * bit + axis);
    ++axis;
  }
  return cell;
}

template <class Bytes, class Saved>
void block_fields(Bytes& bytes, Saved& block) {
  bytes.number(block.name.number);
  bytes.numbers(block.positions);
  bytes.numbers(block.attributes);
  bytes.numbers(block.times);
  bytes.number(block.bounds);
  bytes.number(block.changed_frame);
  bytes.number(block.name.moved_frame);
}

}  // namespace

bool is_alive(const shared::vec4& position_confidence) { return position_confidence.w > 0; }

SurfelBlock empty_block(const BlockName& name) {
  return {name,
          std::vector<shared::vec4>(kSlotsPerBlock),
          std::vector<shared::SurfelAttributes>(kSlotsPerBlock),
          std::vector<shared::uvec2>(kSlotsPerBlock),
          {},
          name.moved_frame};
}

void describe(SurfelBlock& block) {
  block.alive_count = 0;
  for (std::size_t slot = 0; slot < kSlotsPerBlock; ++slot) {
    if (!is_alive(block.positions[slot])) continue;
    ++block.alive_count;
    block.submap = block.attributes[slot].radius_submap >> 16;
  }
}

std::vector<Surfel> surfels_of(const SurfelBlock& block) {
  std::vector<Surfel> surfels(kSlotsPerBlock);
  for (std::size_t i = 0; i < kSlotsPerBlock; ++i)
    surfels[i] = unpack(block.positions[i], block.attributes[i], block.times[i]);
  return surfels;
}

std::vector<SurfelBlock> regrouped(const std::vector<SurfelBlock>& sparse,
                                   std::uint32_t frame_number) {
  struct Place {
    std::uint32_t submap, cell;
    std::size_t block, slot;
  };
  std::vector<Place> places;
  for (std::size_t block = 0; block < sparse.size(); ++block)
    for (std::size_t slot = 0; slot < kSlotsPerBlock; ++slot)
      if (const shared::vec4& p = sparse[block].positions[slot]; is_alive(p))
        places.push_back({sparse[block].submap, cell_of(p), block, slot});
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.submap, a.cell) < std::tie(b.submap, b.cell);
  });
  std::vector<SurfelBlock> blocks;
  for (const Place& from : places) {
    if (blocks.empty() || blocks.back().submap != from.submap ||
        blocks.back().alive_count == kSlotsPerBlock) {
      blocks.push_back(empty_block({0, frame_number}));
      blocks.back().submap = from.submap;
    }
    SurfelBlock& to = blocks.back();
    const SurfelBlock& old = sparse[from.block];
    to.positions[to.alive_count] = old.positions[from.slot];
    to.attributes[to.alive_count] = old.attributes[from.slot];
    to.times[to.alive_count] = old.times[from.slot];
    ++to.alive_count;
  }
  for (SurfelBlock& block : blocks) block.bounds = bounds_of(surfels_of(block)).front();
  return blocks;
}

void save(ByteWriter& bytes, const SurfelBlock& block) { block_fields(bytes, block); }

void restore(ByteReader& bytes, SurfelBlock& block, std::size_t submap_count) {
  block_fields(bytes, block);
  bytes.require(block.positions.size() == kSlotsPerBlock &&
                    block.attributes.size() == kSlotsPerBlock &&
                    block.times.size() == kSlotsPerBlock,
                "a block has a wrong size");
  if (!bytes.ok()) return;
  check_surfels(bytes, block.positions, block.attributes, submap_count);
  describe(block);
}

void check_surfels(ByteReader& bytes, std::span<const shared::vec4> positions,
                   std::span<const shared::SurfelAttributes> attributes, std::size_t submap_count) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const shared::vec4& p = positions[i];
    bytes.require(
        std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w),
        "a surfel's position is not finite");
    bytes.require(!is_alive(p) || attributes[i].radius_submap >> 16 < submap_count,
                  "the submap of a surfel is out of range");
  }
}

}  // namespace hermite::map
