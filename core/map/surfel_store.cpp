#include "core/map/surfel_store.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <tuple>

#include "core/base/check.h"
#include "core/frame/shared_transform.h"

namespace hermite {

namespace {

constexpr std::uint32_t kFirstCapacity = 1u << 19;

// Up to this many slots in excess (3 MB), copying the map is not worth while.
constexpr std::uint32_t kCompactedSlots = 1u << 16;

// Moves every point to z = -1 m, where no pass sees it.
constexpr shared::Transform kBehindTheCamera{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, -1}};

// Returns the position's index along a Morton curve through cells of 2 cm, which keeps neighbours
// together.
std::uint32_t cell_of(const shared::vec4& position) {
  constexpr float kCell_m = 0.02f;
  constexpr int kBits = 10;  // an axis: 20 m around the submap's origin
  std::uint32_t cell = 0;
  int axis = 0;
  for (const float p_m : {position.x, position.y, position.z}) {
    const float at = std::clamp(p_m / kCell_m + float{1 << (kBits - 1)}, 0.0f, float{(1 << kBits) - 1});
    const auto index = static_cast<std::uint32_t>(at);
    for (int bit = 0; bit < kBits; ++bit) cell |= ((index >> bit) & 1u) << (3 * bit + axis);
    ++axis;
  }
  return cell;
}

// Replaces a buffer by a larger one that begins with the old content.
template <class T>
void grow(gpu::Device& device, gpu::Buffer<T>& buffer, std::size_t count) {
  gpu::Buffer<T> larger(device, count, "map");
  if (buffer.count() > 0) {
    gpu::Commands commands(device);
    commands.copy(buffer, larger, buffer.bytes());
    commands.submit_and_wait();
  }
  buffer = std::move(larger);
}

}  // namespace

SurfelStore::SurfelStore(gpu::Device& device, std::uint32_t max_slots)
    : state(device, 1, "map", gpu::Memory::kReadback),
      camera_from_submap(device, 1, "map"),
      device_(device),
      max_slots_(std::min(max_slots, kMaxStoreSlots) / kSlotsPerBlock * kSlotsPerBlock),
      world_from_submap_(1) {
  reserve(std::min(kFirstCapacity, max_slots_));
}

void SurfelStore::reserve(std::uint32_t additional) {
  if (!has_room_for(additional))
    throw gpu::DeviceError("the map is full: it has " + std::to_string(slot_count()) + " surfels on the device, at most " +
                           std::to_string(max_slots_) + " fit");
  const std::uint32_t wanted = slot_count() + additional;
  if (wanted <= capacity_) return;
  const std::uint32_t block_count =
      (std::min(std::max(wanted, capacity_ + capacity_ / 2), max_slots_) + kSlotsPerBlock - 1) / kSlotsPerBlock;
  const std::uint32_t capacity = block_count * kSlotsPerBlock;  // whole blocks, so that a pass may access all slots of one
  grow(device_, positions, capacity);
  grow(device_, attributes, capacity);
  grow(device_, times, capacity);
  grow(device_, free_slots, capacity);
  grow(device_, bounds, block_count);
  grow(device_, changed_frames, block_count);
  group_counts = gpu::Buffer<shared::uint>(device_, block_count, "map");
  visible_blocks = gpu::Buffer<shared::uint>(device_, HERMITE_VISIBLE_HEAD_WORDS + block_count, "map");
  capacity_ = capacity;
}

void SurfelStore::set_submaps(std::span<const Rigid3> world_from_submap) {
  CHECK(world_from_submap.size() >= world_from_submap_.size() && world_from_submap.size() <= kMaxSubmaps,
        "submaps cannot be removed, and at most kMaxSubmaps can exist");
  world_from_submap_.assign(world_from_submap.begin(), world_from_submap.end());
  if (camera_from_submap.count() < world_from_submap_.size())
    camera_from_submap = gpu::Buffer<shared::Transform>(device_, std::bit_ceil(world_from_submap_.size()), "map");
}

void SurfelStore::set_camera(const Rigid3& world_from_camera) { set_camera(world_from_camera, SubmapSet(world_from_submap_.size(), true)); }

void SurfelStore::set_camera(const Rigid3& world_from_camera, const SubmapSet& seen) {
  CHECK(seen.size() == world_from_submap_.size(), "the set of visible submaps must have an entry for every submap");
  const Rigid3 camera_from_world = inverse(world_from_camera);
  std::vector<shared::Transform> transforms;
  for (std::size_t submap = 0; submap < seen.size(); ++submap)
    transforms.push_back(seen[submap] ? to_shared(camera_from_world * world_from_submap_[submap]) : kBehindTheCamera);
  camera_from_submap.upload(transforms);
}

void SurfelStore::begin_block() {
  shared::MapState after = counters();
  after.slot_count = (after.slot_count + kSlotsPerBlock - 1) / kSlotsPerBlock * kSlotsPerBlock;
  after.free_count = 0;
  for (shared::ZoneSlots& zone : after.zones) zone.free_count = 0;
  state.upload(std::vector<shared::MapState>{after});
}

void SurfelStore::append(std::span<const Surfel> surfels) {
  const std::uint32_t first_block = (slot_count() + kSlotsPerBlock - 1) / kSlotsPerBlock, first = first_block * kSlotsPerBlock;
  if (surfels.size() > max_slots_) throw gpu::DeviceError("the map has no room for " + std::to_string(surfels.size()) + " surfels");
  reserve(first - slot_count() + static_cast<std::uint32_t>(surfels.size()));
  std::vector<shared::vec4> new_positions;
  std::vector<shared::SurfelAttributes> new_attributes;
  std::vector<shared::uvec2> new_times;
  for (const Surfel& s : surfels) {
    new_positions.push_back({s.position_in_submap_m.x(), s.position_in_submap_m.y(), s.position_in_submap_m.z(), s.confidence});
    new_attributes.push_back(pack_attributes(s));
    new_times.push_back({s.created_frame, s.observed_frame});
  }
  positions.upload(new_positions, first);
  attributes.upload(new_attributes, first);
  times.upload(new_times, first);
  const std::vector<shared::BlockBounds> new_bounds = bounds_of(surfels);
  bounds.upload(new_bounds, first_block);
  std::vector<shared::uint> changed(new_bounds.size(), 0);
  for (std::size_t i = 0; i < surfels.size(); ++i)
    changed[i / kSlotsPerBlock] = std::max(changed[i / kSlotsPerBlock], surfels[i].observed_frame);
  changed_frames.upload(changed, first_block);
  shared::MapState after = counters();
  after.slot_count = first + static_cast<std::uint32_t>(surfels.size());
  after.alive_count += static_cast<std::uint32_t>(surfels.size());
  state.upload(std::vector<shared::MapState>{after});
}

std::vector<Surfel> SurfelStore::download() const {
  const std::vector<shared::vec4> p = positions.download(slot_count());
  const std::vector<shared::SurfelAttributes> a = attributes.download(slot_count());
  const std::vector<shared::uvec2> t = times.download(slot_count());
  std::vector<Surfel> surfels(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) surfels[i] = unpack(p[i], a[i], t[i]);
  return surfels;
}

SurfelStore::Name SurfelStore::name_of(std::uint32_t block) const {
  return block < names_.size() ? names_[block] : Name{next_number_ + block - static_cast<std::uint32_t>(names_.size())};
}

// Appends downloaded blocks to `blocks`. One transfer per array, however many blocks, because each
// costs a round trip to a device with its own memory.
void SurfelStore::download_blocks(std::uint32_t first, std::uint32_t count, std::vector<Block>& blocks) const {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock, first_slot = std::size_t{first} * kSlotsPerBlock;
  const std::vector<shared::vec4> p = positions.download(slots, first_slot);
  const std::vector<shared::SurfelAttributes> a = attributes.download(slots, first_slot);
  const std::vector<shared::uvec2> t = times.download(slots, first_slot);
  const std::vector<shared::BlockBounds> b = bounds.download(count, first);
  const std::vector<shared::uint> changed = changed_frames.download(count, first);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(std::size_t{i} * kSlotsPerBlock),
               end = begin + static_cast<std::ptrdiff_t>(kSlotsPerBlock);
    const Name name = name_of(first + i);
    Block block{name.number,
                {p.begin() + begin, p.begin() + end},
                {a.begin() + begin, a.begin() + end},
                {t.begin() + begin, t.begin() + end},
                b[i],
                changed[i],
                name.moved_frame};
    describe(block);
    blocks.push_back(std::move(block));
  }
}

// Uploads blocks to the device, from the first block on.
void SurfelStore::upload_blocks(std::span<const Block> blocks) {
  std::vector<shared::vec4> p;
  std::vector<shared::SurfelAttributes> a;
  std::vector<shared::uvec2> t;
  std::vector<shared::BlockBounds> b;
  std::vector<shared::uint> changed;
  for (const Block& block : blocks) {
    p.insert(p.end(), block.positions.begin(), block.positions.end());
    a.insert(a.end(), block.attributes.begin(), block.attributes.end());
    t.insert(t.end(), block.times.begin(), block.times.end());
    b.push_back(block.bounds);
    changed.push_back(block.changed_frame);
  }
  positions.upload(p);
  attributes.upload(a);
  times.upload(t);
  bounds.upload(b);
  changed_frames.upload(changed);
}

void SurfelStore::clear_blocks(std::uint32_t first, std::uint32_t count) {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock, first_slot = std::size_t{first} * kSlotsPerBlock;
  positions.upload(std::vector<shared::vec4>(slots), first_slot);
  attributes.upload(std::vector<shared::SurfelAttributes>(slots), first_slot);
  times.upload(std::vector<shared::uvec2>(slots), first_slot);
  bounds.upload(std::vector<shared::BlockBounds>(count), first);
  changed_frames.upload(std::vector<shared::uint>(count), first);
}

// Replaces the blocks on the device by these.
void SurfelStore::replace_blocks(std::span<const Block> blocks) {
  const std::uint32_t count_before = block_count();
  const auto count = static_cast<std::uint32_t>(blocks.size());
  shared::MapState after{};
  state.upload(std::vector{after});  // empty, so that reserve() has room for the new blocks
  reserve(count * kSlotsPerBlock);
  upload_blocks(blocks);
  if (count < count_before) clear_blocks(count, count_before - count);
  names_.clear();
  for (const Block& block : blocks) {
    names_.push_back({block.number, block.moved_frame});
    after.alive_count += block.alive_count;
  }
  after.slot_count = count * kSlotsPerBlock;
  state.upload(std::vector{after});
}

// Returns the blocks on the device with their numbers.
std::vector<SurfelStore::Block> SurfelStore::take_blocks() {
  std::vector<Block> all;
  download_blocks(0, block_count(), all);
  next_number_ += block_count() - static_cast<std::uint32_t>(names_.size());
  return all;
}

bool SurfelStore::keep(const SubmapSet& submaps) {
  // Empty blocks stay on the device, since changed_blocks() may still have to report the removal of
  // their surfels.
  const auto stays = [&submaps](const Block& block) { return block.alive_count == 0 || submaps[block.submap]; };
  std::vector<Block> on_device = take_blocks();
  auto block_count = static_cast<std::size_t>(std::count_if(on_device.begin(), on_device.end(), stays));
  for (const auto& [submap, blocks] : host_blocks_) block_count += submaps[submap] ? blocks.size() : 0;
  if (block_count > max_slots_ / kSlotsPerBlock) {
    replace_blocks(on_device);
    return false;
  }
  std::vector<Block> kept;
  std::map<std::uint32_t, std::vector<Block>> leaving;
  for (Block& block : on_device) (stays(block) ? kept : leaving[block.submap]).push_back(std::move(block));
  for (auto& [submap, blocks] : host_blocks_)
    if (submaps[submap]) std::move(blocks.begin(), blocks.end(), std::back_inserter(kept));
  std::erase_if(host_blocks_, [&](const auto& entry) { return submaps[entry.first]; });
  for (auto& [submap, blocks] : leaving) std::move(blocks.begin(), blocks.end(), std::back_inserter(host_blocks_[submap]));
  replace_blocks(kept);
  return true;
}

bool SurfelStore::is_sparse() const {
  const std::uint64_t left_by_compact = 2 * std::uint64_t{alive_count()} + kSlotsPerBlock * world_from_submap_.size();
  const std::uint64_t room = std::min(alive_count() + kCompactedSlots, max_slots_ / 4);
  return slot_count() > left_by_compact + room;
}

void SurfelStore::compact(std::uint32_t frame_number) {
  std::vector<Block> kept, sparse;
  for (Block& block : take_blocks()) {
    const bool stays = 2 * block.alive_count >= kSlotsPerBlock;
    if (!stays) gone_blocks_.push_back({block.number, frame_number});
    (stays ? kept : sparse).push_back(std::move(block));
  }
  for (Block& block : regrouped(sparse, frame_number)) kept.push_back(std::move(block));
  replace_blocks(kept);
}

// Returns the surfels of these blocks in the smallest possible number of new blocks.
std::vector<SurfelStore::Block> SurfelStore::regrouped(const std::vector<Block>& sparse, std::uint32_t frame_number) {
  struct Place {
    std::uint32_t submap, cell;
    std::size_t block, slot;
  };
  std::vector<Place> places;
  for (std::size_t block = 0; block < sparse.size(); ++block)
    for (std::size_t slot = 0; slot < kSlotsPerBlock; ++slot)
      if (const shared::vec4& p = sparse[block].positions[slot]; p.w > 0) places.push_back({sparse[block].submap, cell_of(p), block, slot});
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return std::tie(a.submap, a.cell) < std::tie(b.submap, b.cell); });
  std::vector<Block> blocks;
  for (const Place& from : places) {
    if (blocks.empty() || blocks.back().submap != from.submap || blocks.back().alive_count == kSlotsPerBlock) {
      blocks.push_back(empty_block({next_number_++, frame_number}));
      blocks.back().submap = from.submap;
    }
    Block& to = blocks.back();
    const Block& old = sparse[from.block];
    to.positions[to.alive_count] = old.positions[from.slot];
    to.attributes[to.alive_count] = old.attributes[from.slot];
    to.times[to.alive_count] = old.times[from.slot];
    ++to.alive_count;
  }
  for (Block& block : blocks) block.bounds = bounds_of(surfels_of(block)).front();
  return blocks;
}

// Returns a block without surfels.
SurfelStore::Block SurfelStore::empty_block(const Name& name) {
  return {name.number,
          std::vector<shared::vec4>(kSlotsPerBlock),
          std::vector<shared::SurfelAttributes>(kSlotsPerBlock),
          std::vector<shared::uvec2>(kSlotsPerBlock),
          {},
          name.moved_frame,
          name.moved_frame};
}

std::vector<Surfel> SurfelStore::surfels_of(const Block& block) {
  std::vector<Surfel> surfels(kSlotsPerBlock);
  for (std::size_t i = 0; i < kSlotsPerBlock; ++i) surfels[i] = unpack(block.positions[i], block.attributes[i], block.times[i]);
  return surfels;
}

std::vector<NumberedSurfel> SurfelStore::changed_blocks(std::uint32_t since) const {
  std::vector<Block> changed;
  const std::vector<shared::uint> frames = changed_frames.download(block_count());
  const auto has_changed = [since](std::uint32_t frame) { return frame > since; };
  for (auto begin = std::find_if(frames.begin(), frames.end(), has_changed); begin != frames.end();) {
    const auto end = std::find_if_not(begin, frames.end(), has_changed);
    download_blocks(static_cast<std::uint32_t>(begin - frames.begin()), static_cast<std::uint32_t>(end - begin), changed);
    begin = std::find_if(end, frames.end(), has_changed);
  }
  for (const auto& [submap, blocks] : host_blocks_)
    for (const Block& block : blocks)
      if (block.changed_frame > since) changed.push_back(block);
  for (const Name& gone : gone_blocks_)
    if (since > 0 && gone.moved_frame > since) changed.push_back(empty_block(gone));
  std::sort(changed.begin(), changed.end(), [](const Block& a, const Block& b) { return a.number < b.number; });
  std::vector<NumberedSurfel> surfels;
  surfels.reserve(changed.size() * kSlotsPerBlock);
  for (const Block& block : changed)
    for (std::uint32_t i = 0; const Surfel& surfel : surfels_of(block))
      surfels.push_back({block.number * kSlotsPerBlock + i++, surfel, std::max(surfel.observed_frame, block.moved_frame)});
  return surfels;
}

std::int64_t SurfelStore::surfel_count() const {
  std::int64_t count = alive_count();
  for (const auto& [submap, blocks] : host_blocks_)
    for (const Block& block : blocks) count += block.alive_count;
  return count;
}

std::int64_t SurfelStore::host_bytes() const {
  constexpr std::size_t kBytesPerBlock =
      kSlotsPerBlock * (sizeof(shared::vec4) + sizeof(shared::SurfelAttributes) + sizeof(shared::uvec2)) + sizeof(Block);
  std::size_t blocks_count = 0;
  for (const auto& [submap, blocks] : host_blocks_) blocks_count += blocks.size();
  return static_cast<std::int64_t>(blocks_count * kBytesPerBlock);
}

}  // namespace hermite
