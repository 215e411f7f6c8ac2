// Serialisation of SurfelStore. Everything that a pass over the map can observe must be the same
// afterwards.
#include <algorithm>
#include <cmath>

#include "core/map/surfel_store.h"
#include "core/math/rigid3_fields.h"

namespace hermite {

namespace {

// The number of blocks with all slots that a scan's changes can address (core/output/chunks.h).
constexpr std::uint32_t kMaxBlockNumber = 1u << 20;

bool is_alive(const shared::vec4& position) { return position.w > 0; }

void check_surfels(ByteReader& bytes, std::span<const shared::vec4> positions, std::span<const shared::SurfelAttributes> attributes,
                   std::size_t submap_count) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const shared::vec4& p = positions[i];
    bytes.require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w),
                  "a surfel's position is not finite");
    bytes.require(!is_alive(p) || attributes[i].radius_submap >> 16 < submap_count, "the submap of a surfel is out of range");
  }
}

}  // namespace

// The arrays per slot and per block, as on the device.
struct SurfelStore::OnDevice {
  shared::MapState state{};
  std::vector<shared::vec4> positions;
  std::vector<shared::SurfelAttributes> attributes;
  std::vector<shared::uvec2> times;
  std::vector<shared::BlockBounds> bounds;
  std::vector<shared::uint> changed_frames, free_slots;
};

template <class Bytes, class Saved>
void SurfelStore::block_fields(Bytes& bytes, Saved& block) {
  bytes.number(block.number);
  bytes.numbers(block.positions);
  bytes.numbers(block.attributes);
  bytes.numbers(block.times);
  bytes.number(block.bounds);
  bytes.number(block.changed_frame);
  bytes.number(block.moved_frame);
}

template <class Bytes, class Saved>
void SurfelStore::name_fields(Bytes& bytes, Saved& store) {
  bytes.numbers(store.names_);
  bytes.number(store.next_number_);
  bytes.numbers(store.gone_blocks_);
}

// Computes the derived fields of a block from its surfels.
void SurfelStore::describe(Block& block) {
  block.alive_count = 0;
  for (std::size_t slot = 0; slot < kSlotsPerBlock; ++slot) {
    if (!is_alive(block.positions[slot])) continue;
    ++block.alive_count;
    block.submap = block.attributes[slot].radius_submap >> 16;
  }
}

// Downloads one array after the other, so that they are never all in memory twice.
void SurfelStore::save(ByteWriter& bytes) const {
  const std::size_t slots = std::size_t{block_count()} * kSlotsPerBlock;
  bytes.list(world_from_submap_, [](ByteWriter& to, const Rigid3& pose) { rigid3_fields(to, pose); });
  bytes.number(counters());
  bytes.numbers(positions.download(slots));
  bytes.numbers(attributes.download(slots));
  bytes.numbers(times.download(slots));
  bytes.numbers(bounds.download(block_count()));
  bytes.numbers(changed_frames.download(block_count()));
  bytes.numbers(free_slots.download(counters().free_count));
  name_fields(bytes, *this);
  bytes.number(static_cast<std::uint32_t>(host_blocks_.size()));
  for (const auto& [submap, blocks] : host_blocks_) {
    bytes.number(submap);
    bytes.list(blocks, [](ByteWriter& to, const Block& block) { block_fields(to, block); });
  }
}

void SurfelStore::check(ByteReader& bytes, const OnDevice& saved, std::size_t submap_count) {
  const shared::MapState& state = saved.state;
  const std::size_t blocks = saved.bounds.size(), slots = saved.positions.size();
  bytes.require(submap_count >= 1 && submap_count <= kMaxSubmaps, "the number of submaps is out of range");
  bytes.require(blocks == (std::size_t{state.slot_count} + kSlotsPerBlock - 1) / kSlotsPerBlock && slots == blocks * kSlotsPerBlock &&
                    saved.attributes.size() == slots && saved.times.size() == slots && saved.changed_frames.size() == blocks,
                "the arrays have different lengths");
  if (!bytes.ok()) return;
  check_surfels(bytes, saved.positions, saved.attributes, submap_count);
  bytes.require(state.alive_count <= state.slot_count, "the number of surfels is out of range");
  bytes.require(state.new_count == 0 && state.fresh_count == 0 && state.freed_count == 0, "the counters are from within a frame");
  bytes.require(state.free_count == saved.free_slots.size(), "the number of free slots is inconsistent");
  std::vector<bool> is_listed(slots, false);
  for (const shared::uint slot : saved.free_slots) {
    const bool right = slot < state.slot_count && !is_listed[slot] && !is_alive(saved.positions[slot]);
    bytes.require(right, "a free slot is in use, out of range or listed twice");
    if (right) is_listed[slot] = true;
  }
  for (const shared::ZoneSlots& zone : state.zones)
    bytes.require(zone.free_count == 0 || (zone.free_begin <= state.free_count && zone.free_count <= state.free_count - zone.free_begin),
                  "the free slots of a zone are out of range");
}

void SurfelStore::read_host_blocks(ByteReader& bytes, std::size_t submap_count, std::map<std::uint32_t, std::vector<Block>>& host_blocks) {
  std::uint32_t left = 0;
  bytes.number(left);
  for (; left > 0 && bytes.ok(); --left) {
    std::uint32_t submap = 0;
    bytes.number(submap);
    bytes.require(submap < submap_count && !host_blocks.contains(submap), "the submap of host blocks is out of range or occurs twice");
    bytes.list(host_blocks[submap], [submap_count](ByteReader& from, Block& block) {
      block_fields(from, block);
      from.require(
          block.positions.size() == kSlotsPerBlock && block.attributes.size() == kSlotsPerBlock && block.times.size() == kSlotsPerBlock,
          "a block has a wrong size");
      if (!from.ok()) return;
      check_surfels(from, block.positions, block.attributes, submap_count);
      describe(block);
    });
  }
}

// Checks that each block number occurs once among the blocks on the device, on the host and removed
// ones.
void SurfelStore::check_numbers(ByteReader& bytes, std::size_t blocks_on_device) const {
  const std::size_t named = names_.size();
  bytes.require(named <= blocks_on_device && next_number_ <= kMaxBlockNumber - std::min<std::size_t>(blocks_on_device, kMaxBlockNumber),
                "the block numbers are out of range");
  if (!bytes.ok()) return;
  std::vector<bool> is_taken(next_number_, false);
  const auto take = [&](std::uint32_t number) {
    const bool right = number < next_number_ && !is_taken[number];
    bytes.require(right, "a block number is out of range or occurs twice");
    if (right) is_taken[number] = true;
  };
  for (const Name& name : names_) take(name.number);
  for (const auto& [submap, blocks] : host_blocks_)
    for (const Block& block : blocks) take(block.number);
  for (const Name& gone : gone_blocks_) take(gone.number);
}

void SurfelStore::restore(ByteReader& bytes) {
  OnDevice saved;
  std::vector<Rigid3> poses;
  bytes.list(poses, [](ByteReader& from, Rigid3& pose) { rigid3_fields(from, pose); });
  bytes.number(saved.state);
  bytes.numbers(saved.positions);
  bytes.numbers(saved.attributes);
  bytes.numbers(saved.times);
  bytes.numbers(saved.bounds);
  bytes.numbers(saved.changed_frames);
  bytes.numbers(saved.free_slots);
  check(bytes, saved, poses.size());
  name_fields(bytes, *this);
  read_host_blocks(bytes, poses.size(), host_blocks_);
  check_numbers(bytes, saved.bounds.size());
  if (!bytes.ok()) return;
  set_submaps(poses);
  reserve(static_cast<std::uint32_t>(saved.positions.size()));
  positions.upload(saved.positions);
  attributes.upload(saved.attributes);
  times.upload(saved.times);
  bounds.upload(saved.bounds);
  changed_frames.upload(saved.changed_frames);
  free_slots.upload(saved.free_slots);
  state.upload(std::vector{saved.state});
}

}  // namespace hermite
