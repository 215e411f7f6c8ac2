#include "core/map/surfel_store.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "core/base/check.h"
#include "core/frame/shared_transform.h"
#include "core/math/rigid3_fields.h"

namespace hermite::map {

namespace {

constexpr std::uint32_t kFirstCapacity = 1u << 19;

// Up to this many slots in excess (3 MB), copying the map is not worth while.
constexpr std::uint32_t kCompactedSlots = 1u << 16;

// Moves every point to z = -1 m, where no pass sees it.
constexpr shared::Transform kBehindTheCamera{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, -1}};

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
    throw gpu::DeviceError(
        fmt::format("the map is full: it has {} surfels on the device, at most {} fit",
                    slot_count(), max_slots_));
  const std::uint32_t wanted = slot_count() + additional;
  if (wanted <= capacity_) return;
  const std::uint32_t block_count =
      (std::min(std::max(wanted, capacity_ + capacity_ / 2), max_slots_) + kSlotsPerBlock - 1) /
      kSlotsPerBlock;
  // Whole blocks, so that a pass may access all slots of one.
  const std::uint32_t capacity = block_count * kSlotsPerBlock;
  grow(device_, positions, capacity);
  grow(device_, attributes, capacity);
  grow(device_, times, capacity);
  grow(device_, free_slots, capacity);
  grow(device_, bounds, block_count);
  grow(device_, changed_frames, block_count);
  group_counts = gpu::Buffer<shared::uint>(device_, block_count, "map");
  visible_blocks =
      gpu::Buffer<shared::uint>(device_, HERMITE_VISIBLE_HEAD_WORDS + block_count, "map");
  capacity_ = capacity;
}

void SurfelStore::set_submaps(std::span<const Rigid3> world_from_submap) {
  CHECK(world_from_submap.size() >= world_from_submap_.size() &&
            world_from_submap.size() <= kMaxSubmaps,
        "submaps cannot be removed, and at most kMaxSubmaps can exist");
  world_from_submap_.assign(world_from_submap.begin(), world_from_submap.end());
  if (camera_from_submap.count() < world_from_submap_.size())
    camera_from_submap =
        gpu::Buffer<shared::Transform>(device_, std::bit_ceil(world_from_submap_.size()), "map");
}

void SurfelStore::set_camera(const Rigid3& world_from_camera) {
  set_camera(world_from_camera, SubmapSet(world_from_submap_.size(), true));
}

void SurfelStore::set_camera(const Rigid3& world_from_camera, const SubmapSet& seen) {
  CHECK(seen.size() == world_from_submap_.size(),
        "the set of visible submaps must have an entry for every submap");
  const Rigid3 camera_from_world = inverse(world_from_camera);
  std::vector<shared::Transform> transforms;
  for (std::size_t submap = 0; submap < seen.size(); ++submap)
    transforms.push_back(seen[submap]
                             ? frame::to_shared(camera_from_world * world_from_submap_[submap])
                             : kBehindTheCamera);
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
  const std::uint32_t first_block = (slot_count() + kSlotsPerBlock - 1) / kSlotsPerBlock,
                      first = first_block * kSlotsPerBlock;
  if (surfels.size() > max_slots_)
    throw gpu::DeviceError(fmt::format("the map has no room for {} surfels", surfels.size()));
  reserve(first - slot_count() + static_cast<std::uint32_t>(surfels.size()));
  upload(arrays_of(surfels), first_block);
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

// Appends downloaded blocks to `blocks`. One transfer per array, however many blocks, because each
// costs a round trip to a device with its own memory.
void SurfelStore::download_blocks(std::uint32_t first, std::uint32_t count,
                                  std::vector<SurfelBlock>& blocks) const {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock,
                    first_slot = std::size_t{first} * kSlotsPerBlock;
  const SlotArrays arrays{positions.download(slots, first_slot),
                          attributes.download(slots, first_slot), times.download(slots, first_slot),
                          bounds.download(count, first), changed_frames.download(count, first)};
  for (std::uint32_t i = 0; i < count; ++i)
    blocks.push_back(block_at(arrays, i, numbers_.name_of(first + i)));
}

void SurfelStore::upload(const SlotArrays& arrays, std::uint32_t first_block) {
  const std::size_t first_slot = std::size_t{first_block} * kSlotsPerBlock;
  positions.upload(arrays.positions, first_slot);
  attributes.upload(arrays.attributes, first_slot);
  times.upload(arrays.times, first_slot);
  bounds.upload(arrays.bounds, first_block);
  changed_frames.upload(arrays.changed_frames, first_block);
}

// Replaces the blocks on the device by these.
void SurfelStore::replace_blocks(std::span<const SurfelBlock> blocks) {
  const std::uint32_t count_before = block_count();
  const auto count = static_cast<std::uint32_t>(blocks.size());
  shared::MapState after{};
  state.upload(std::vector{after});  // empty, so that reserve() has room for the new blocks
  reserve(count * kSlotsPerBlock);
  upload(arrays_of(blocks), 0);
  if (count < count_before) upload(free_arrays(count_before - count), count);
  numbers_.place(blocks);
  for (const SurfelBlock& block : blocks) after.alive_count += block.alive_count;
  after.slot_count = count * kSlotsPerBlock;
  state.upload(std::vector{after});
}

// Returns the blocks on the device with their numbers.
std::vector<SurfelBlock> SurfelStore::take_blocks() {
  numbers_.fix(block_count());
  std::vector<SurfelBlock> all;
  download_blocks(0, block_count(), all);
  return all;
}

bool SurfelStore::keep(const SubmapSet& submaps) {
  // Empty blocks stay on the device, since changed_blocks() may still have to report the removal of
  // their surfels.
  const auto stays = [&submaps](const SurfelBlock& block) {
    return block.alive_count == 0 || submaps[block.submap];
  };
  std::vector<SurfelBlock> on_device = take_blocks();
  const auto staying =
      static_cast<std::size_t>(std::count_if(on_device.begin(), on_device.end(), stays));
  if (staying + host_blocks_.count_of(submaps) > max_slots_ / kSlotsPerBlock) {
    replace_blocks(on_device);
    return false;
  }
  std::vector<SurfelBlock> kept, leaving;
  for (SurfelBlock& block : on_device) (stays(block) ? kept : leaving).push_back(std::move(block));
  host_blocks_.take(submaps, kept);
  for (SurfelBlock& block : leaving) host_blocks_.add(std::move(block));
  replace_blocks(kept);
  return true;
}

bool SurfelStore::is_sparse() const {
  const std::uint64_t left_by_compact =
      2 * std::uint64_t{alive_count()} + kSlotsPerBlock * world_from_submap_.size();
  const std::uint64_t room = std::min(alive_count() + kCompactedSlots, max_slots_ / 4);
  return slot_count() > left_by_compact + room;
}

void SurfelStore::compact(std::uint32_t frame_number) {
  std::vector<SurfelBlock> kept, sparse;
  for (SurfelBlock& block : take_blocks()) {
    const bool stays = 2 * block.alive_count >= kSlotsPerBlock;
    if (!stays) numbers_.retire(block.name.number, frame_number);
    (stays ? kept : sparse).push_back(std::move(block));
  }
  for (SurfelBlock& block : regrouped(sparse, frame_number)) {
    block.name.number = numbers_.next();
    kept.push_back(std::move(block));
  }
  replace_blocks(kept);
}

std::vector<NumberedSurfel> SurfelStore::changed_blocks(std::uint32_t since) const {
  std::vector<SurfelBlock> changed;
  const std::vector<shared::uint> frames = changed_frames.download(block_count());
  const auto has_changed = [since](std::uint32_t frame) { return frame > since; };
  for (auto begin = std::find_if(frames.begin(), frames.end(), has_changed);
       begin != frames.end();) {
    const auto end = std::find_if_not(begin, frames.end(), has_changed);
    download_blocks(static_cast<std::uint32_t>(begin - frames.begin()),
                    static_cast<std::uint32_t>(end - begin), changed);
    begin = std::find_if(end, frames.end(), has_changed);
  }
  host_blocks_.copy_changed(since, changed);
  for (const BlockName& gone : numbers_.gone_blocks())
    if (since > 0 && gone.moved_frame > since) changed.push_back(empty_block(gone));
  std::sort(changed.begin(), changed.end(), [](const SurfelBlock& a, const SurfelBlock& b) {
    return a.name.number < b.name.number;
  });
  std::vector<NumberedSurfel> surfels;
  surfels.reserve(changed.size() * kSlotsPerBlock);
  for (const SurfelBlock& block : changed)
    for (std::uint32_t i = 0; const Surfel& surfel : surfels_of(block))
      surfels.push_back({block.name.number * kSlotsPerBlock + i++, surfel,
                         std::max(surfel.observed_frame, block.name.moved_frame)});
  return surfels;
}

std::int64_t SurfelStore::surfel_count() const {
  return alive_count() + host_blocks_.alive_count();
}

std::int64_t SurfelStore::host_bytes() const { return host_blocks_.bytes(); }

// Everything that a pass over the map can observe must be the same after restore(). Downloads one
// array after the other, so that they are never all in memory twice.
void SurfelStore::save(ByteWriter& bytes) const {
  const std::size_t slots = std::size_t{block_count()} * kSlotsPerBlock;
  bytes.list(world_from_submap_,
             [](ByteWriter& to, const Rigid3& pose) { rigid3_fields(to, pose); });
  bytes.number(counters());
  bytes.numbers(positions.download(slots));
  bytes.numbers(attributes.download(slots));
  bytes.numbers(times.download(slots));
  bytes.numbers(bounds.download(block_count()));
  bytes.numbers(changed_frames.download(block_count()));
  bytes.numbers(free_slots.download(counters().free_count));
  numbers_.save(bytes);
  host_blocks_.save(bytes);
}

void SurfelStore::restore(ByteReader& bytes) {
  std::vector<Rigid3> poses;
  bytes.list(poses, [](ByteReader& from, Rigid3& pose) { rigid3_fields(from, pose); });
  bytes.require(!poses.empty() && poses.size() <= kMaxSubmaps,
                "the number of submaps is out of range");
  SavedSlots saved;
  bytes.number(saved.state);
  bytes.numbers(saved.arrays.positions);
  bytes.numbers(saved.arrays.attributes);
  bytes.numbers(saved.arrays.times);
  bytes.numbers(saved.arrays.bounds);
  bytes.numbers(saved.arrays.changed_frames);
  bytes.numbers(saved.free_slots);
  check_slots(bytes, saved, poses.size());
  numbers_.restore(bytes);
  host_blocks_.restore(bytes, poses.size());
  numbers_.check(bytes, saved.arrays.bounds.size(), host_blocks_.numbers());
  if (!bytes.ok()) return;
  set_submaps(poses);
  reserve(static_cast<std::uint32_t>(saved.arrays.positions.size()));
  upload(saved.arrays, 0);
  free_slots.upload(saved.free_slots);
  state.upload(std::vector{saved.state});
}

}  // namespace hermite::map
