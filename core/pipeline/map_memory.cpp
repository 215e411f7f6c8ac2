#include "core/pipeline/map_memory.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "core/gpu/device.h"
#include "core/gpu/error.h"

namespace hermite::pipeline {

namespace {

// After the map was full, memory is requested again only after this many frames, because that takes
// as long as copying the map.
constexpr std::uint32_t kFullFrames = 8;

}  // namespace

std::uint32_t most_slots(const gpu::Device& device, std::int64_t gpu_memory_mb,
                         std::uint32_t most_new) {
  if (gpu_memory_mb == 0) return map::kMaxStoreSlots;
  constexpr std::int64_t kMegabyte = 1'000'000;
  std::int64_t left_bytes = gpu_memory_mb * kMegabyte;
  for (const auto& [purpose, bytes] : device.memory_by_purpose()) left_bytes -= bytes;
  const std::int64_t slots = left_bytes / map::kBytesPerSlot, least = 4 * std::int64_t{most_new};
  if (slots < least)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         fmt::format("map.gpu_memory_mb is {}, this camera needs at least {}", gpu_memory_mb,
                     gpu_memory_mb + (least - slots) * map::kBytesPerSlot / kMegabyte + 1)});
  return static_cast<std::uint32_t>(std::min<std::int64_t>(slots, map::kMaxStoreSlots));
}

bool MapMemory::hold(const map::SubmapSet& needed, const adjust::MapLayout& layout) {
  bool is_there = store_.has_room_for(most_new_);
  for (std::uint32_t submap = 0; submap < needed.size(); ++submap)
    is_there = is_there && (!needed[submap] || store_.is_on_device(submap));
  if (is_there) return true;
  map::SubmapSet kept = needed;
  for (std::size_t submap = 0; submap < kept.size(); ++submap)
    kept[submap] = kept[submap] || layout.is_active[submap];
  return store_.keep(kept);
}

bool MapMemory::make_room(const adjust::MapLayout& layout, std::uint32_t frame_number) {
  if (frame_number < full_until_frame_) return false;
  const bool made = try_to_make_room(layout, frame_number);
  full_until_frame_ = made ? 0 : frame_number + kFullFrames;
  return made;
}

bool MapMemory::try_to_make_room(const adjust::MapLayout& layout, std::uint32_t frame_number) {
  if (layout.current != submap_) store_.begin_block();
  if (store_.is_sparse()) store_.compact(frame_number);
  if (!hold(layout.is_active, layout) || !store_.has_room_for(most_new_)) return false;
  try {
    store_.reserve(most_new_);
  } catch (const gpu::DeviceError&) {
    // There is less memory than assumed; a lost device reports its error again.
    return false;
  }
  submap_ = layout.current;
  return true;
}

void MapMemory::save(ByteWriter& bytes) const {
  bytes.number(submap_);
  bytes.number(full_until_frame_);
}

void MapMemory::restore(ByteReader& bytes) {
  bytes.number(submap_);
  bytes.number(full_until_frame_);
  bytes.require(submap_ < store_.world_from_submap().size(),
                "the submap of new surfels is out of range");
}

}  // namespace hermite::pipeline
