// The surfels of a map in GPU memory: three arrays with 40 bytes per slot, a list of free slots,
// bounds of blocks of slots, and submap poses. Submaps that are currently not needed may be moved
// to host memory (HostBlocks).
//
// A surfel's position and normal are in the frame of its submap, and all surfels of a block belong
// to one submap. A block has a fixed number, wherever it is stored (BlockNumbers). A surfel keeps
// its slot within its block while it lives; then the slot is reused. Only compact() moves surfels
// to other blocks. One thread at a time, the device's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/map/block_numbers.h"
#include "core/map/host_blocks.h"
#include "core/map/slot_arrays.h"
#include "core/map/surfel.h"
#include "core/math/rigid3.h"
#include "shaders/shared/map.h"

namespace hermite::map {

// The number of blocks that every device can dispatch at once.
inline constexpr std::uint32_t kMaxStoreSlots = 65535 * kSlotsPerBlock;
// Memory of all buffers that grow with the map: the surfel, its entry in the list of free slots,
// its share of the data per block.
inline constexpr std::int64_t kBytesPerSlot = 45;
inline constexpr std::uint32_t kMaxSubmaps = 1u << 16;  // a surfel has 16 bits for its submap

// A surfel with its number, block number * kSlotsPerBlock + slot in the block. Lists are in
// ascending order.
struct NumberedSurfel {
  std::uint32_t number = 0;
  Surfel surfel;  // with confidence 0: the slot is free
  // The frame when it was last observed, removed, or moved here from another block.
  std::uint32_t changed_frame = 0;
};

class SurfelStore {
 public:
  // Never uses more than `max_slots` on the device.
  explicit SurfelStore(gpu::Device& device, std::uint32_t max_slots = kMaxStoreSlots);

  // Makes room for `additional` more slots, growing by half and keeping the content. Throws
  // gpu::DeviceError when the device has no memory or the limit is exceeded.
  void reserve(std::uint32_t additional);
  bool has_room_for(std::uint32_t additional) const {
    return additional <= max_slots_ && slot_count() <= max_slots_ - additional;
  }

  // Keeps only the blocks of these submaps on the device: fetches them from the host and moves
  // others there. Call it between frames; it takes as long as copying the map. Returns false, with
  // nothing changed, when the slots would exceed the limit. Throws as reserve() does.
  bool keep(const SubmapSet& submaps);
  bool is_on_device(std::uint32_t submap) const { return !host_blocks_.has(submap); }

  // Free slots stay with their block, and the camera often needs new ones elsewhere, so a camera
  // that returns to the same places leaves ever more of them. Returns true when there are many
  // times more slots than surfels; false for a while after compact().
  bool is_sparse() const;

  // Moves the surfels of blocks less than half full to new blocks, neighbours together, and removes
  // the old blocks. Afterwards there are at most twice as many slots as surfels, plus a block per
  // submap. Call it between frames, like keep(); changed_blocks() reports the moves as changes of
  // `frame_number`.
  void compact(std::uint32_t frame_number);

  // Sets one pose per submap, of existing and new ones. At first there is only submap 0, in the
  // world frame. A CHECK fails when a submap is removed or there are more than kMaxSubmaps.
  void set_submaps(std::span<const Rigid3> world_from_submap);

  // Sets the camera pose for the next passes. Submaps that are not in `seen` are invisible; without
  // `seen`, all are visible.
  void set_camera(const Rigid3& world_from_camera);
  void set_camera(const Rigid3& world_from_camera, const SubmapSet& seen);

  // The next new surfels belong to another submap and get slots in a block of their own. Call it
  // between frames.
  void begin_block();

  std::uint32_t slot_count() const { return counters().slot_count; }
  std::uint32_t alive_count() const { return counters().alive_count; }
  std::uint32_t capacity() const { return capacity_; }
  const std::vector<Rigid3>& world_from_submap() const { return world_from_submap_; }

  // Appends live surfels after all slots, from the next whole block on, and keeps their order. Call
  // it between frames. Throws as reserve() does.
  void append(std::span<const Surfel> surfels);

  // Returns all slots below slot_count(), including free ones.
  std::vector<Surfel> download() const;

  // Returns the slots of all blocks on device and host that changed after frame `since`; 0: of all
  // blocks in use.
  std::vector<NumberedSurfel> changed_blocks(std::uint32_t since) const;

  // Saves everything between frames; takes as long as copying the map.
  void save(ByteWriter& bytes) const;

  // Restores into a new store. After a failure of the reader, or an exception as in reserve(), it
  // must not be used.
  void restore(ByteReader& bytes);

  // On the device and the host together.
  std::int64_t surfel_count() const;
  std::int64_t host_bytes() const;

  gpu::Buffer<shared::vec4> positions;
  gpu::Buffer<shared::SurfelAttributes> attributes;
  gpu::Buffer<shared::uvec2> times;
  gpu::Buffer<shared::uint> free_slots;
  // Scratch memory of the prefix sums, one entry per block.
  gpu::Buffer<shared::uint> group_counts;
  gpu::Buffer<shared::BlockBounds> bounds;  // per block of 256 slots
  // Per block: the last frame that changed one of its surfels.
  gpu::Buffer<shared::uint> changed_frames;
  gpu::Buffer<shared::uint> visible_blocks;  // shared::VisibleHead, then the list of visible blocks
  gpu::Buffer<shared::MapState> state;       // valid on the host between frames
  gpu::Buffer<shared::Transform> camera_from_submap;

 private:
  shared::MapState counters() const { return state.mapped()[0]; }
  std::uint32_t block_count() const { return (slot_count() + kSlotsPerBlock - 1) / kSlotsPerBlock; }
  void download_blocks(std::uint32_t first, std::uint32_t count,
                       std::vector<SurfelBlock>& blocks) const;
  void upload(const SlotArrays& arrays, std::uint32_t first_block);
  std::vector<SurfelBlock> take_blocks();
  void replace_blocks(std::span<const SurfelBlock> blocks);

  gpu::Device& device_;
  const std::uint32_t max_slots_;
  std::uint32_t capacity_ = 0;
  BlockNumbers numbers_;
  HostBlocks host_blocks_;
  std::vector<Rigid3> world_from_submap_;
};

}  // namespace hermite::map
