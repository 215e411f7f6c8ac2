// The surfels of a map in GPU memory: three arrays of 40 bytes a slot in all, a list of free slots, bounds of blocks of slots, and the
// poses of submaps. Submaps that are not needed for now may wait in the host's memory.
//
// A surfel's position and normal are in the frame of its submap. All surfels of a block are of one submap. A block has a number of its own,
// which it keeps wherever it lies; a surfel keeps its place in its block while it lives, and the place is used again afterwards. Only
// compact() puts surfels into other blocks. One thread at a time: the device's.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/map/surfel.h"
#include "core/math/rigid3.h"
#include "shaders/shared/map.h"

namespace hermite {

// As many blocks as every device can dispatch at once.
inline constexpr std::uint32_t kMaxStoreSlots = 65535 * kSlotsPerBlock;
// Of all buffers that grow with the map: the surfel itself, its place in the list of free slots, its share of what is kept for a block.
inline constexpr std::int64_t kBytesPerSlot = 45;
inline constexpr std::uint32_t kMaxSubmaps = 1u << 16;  // a surfel has 16 bits for its own

// By submap: is it one of them?
using SubmapSet = std::vector<bool>;

shared::Transform to_shared(const Rigid3& target_from_source);

// Of a map with its numbers, in ascending order: block number * kSlotsPerBlock + place in the block.
struct NumberedSurfel {
  std::uint32_t number = 0;
  Surfel surfel;                    // without confidence: none is there
  std::uint32_t changed_frame = 0;  // when it was last observed, went, or came here from another block
};

class SurfelStore {
 public:
  // Never more than `max_slots` on the device.
  explicit SurfelStore(gpu::Device& device, std::uint32_t max_slots = kMaxStoreSlots);

  // Room for `additional` more slots; grows by half, keeping the content. Throws gpu::DeviceError when the device has no more, or beyond
  // the most there may be.
  void reserve(std::uint32_t additional);
  bool has_room_for(std::uint32_t additional) const { return additional <= max_slots_ && slot_count() <= max_slots_ - additional; }

  // Leaves on the device the blocks of these submaps, with those that were on the host, and sends the others there. Between frames; takes
  // time like copying the map. False: there may not be so many slots, and everything is where it was. Throws as reserve() does.
  bool keep(const SubmapSet& submaps);
  bool is_on_device(std::uint32_t submap) const { return !host_blocks_.contains(submap); }

  // Places that died stay with the block that they are in, and few are where the camera needs some: a camera that comes back again and
  // again leaves ever more of them behind. True when there are many times more slots than surfels; not for long after compact().
  bool is_sparse() const;

  // Surfels of blocks less than half full come together in new blocks, neighbours of a submap with neighbours, and all their old blocks go.
  // Leaves at most twice as many slots as surfels, and a block for each submap. Between frames, like keep(); whoever asks for changes since
  // a frame before `frame_number` is told.
  void compact(std::uint32_t frame_number);

  // From now on: one pose for every submap, those there were and new ones. To begin with there is submap 0, where the world is.
  // CHECK: none is taken away, at most kMaxSubmaps.
  void set_submaps(std::span<const Rigid3> world_from_submap);

  // Where the next passes see the submaps from. What is not in `seen` is in no view; without it all are.
  void set_camera(const Rigid3& world_from_camera);
  void set_camera(const Rigid3& world_from_camera, const SubmapSet& seen);

  // The next new surfels are of another submap than those before: they get slots in a block of their own. Between frames.
  void begin_block();

  std::uint32_t slot_count() const { return counters().slot_count; }
  std::uint32_t alive_count() const { return counters().alive_count; }
  std::uint32_t capacity() const { return capacity_; }
  const std::vector<Rigid3>& world_from_submap() const { return world_from_submap_; }

  // Behind all slots, from the next whole block on: surfels that are neighbours in `surfels` stay so. All of them alive; between frames.
  // Throws as reserve() does.
  void append(std::span<const Surfel> surfels);

  // Slots below slot_count(), free ones too.
  std::vector<Surfel> download() const;

  // On device and host, those of blocks that have changed after frame `since` (0: all that hold something).
  std::vector<NumberedSurfel> changed_blocks(std::uint32_t since) const;

  // All of it, between frames; takes time like copying the map.
  void save(ByteWriter& bytes) const;

  // Of a store that nothing has happened to. After a failure of the reader, or a throw as of reserve(), this is of no use any more.
  void restore(ByteReader& bytes);

  // On device and host together.
  std::int64_t surfel_count() const;
  std::int64_t host_bytes() const;

  gpu::Buffer<shared::vec4> positions;
  gpu::Buffer<shared::SurfelAttributes> attributes;
  gpu::Buffer<shared::uvec2> times;
  gpu::Buffer<shared::uint> free_slots;
  gpu::Buffer<shared::uint> group_counts;    // scratch of the prefix sums, one entry for every block
  gpu::Buffer<shared::BlockBounds> bounds;   // by block of 256 slots
  gpu::Buffer<shared::uint> changed_frames;  // by block: the last frame that changed one of its surfels
  gpu::Buffer<shared::uint> visible_blocks;  // shared::VisibleHead, then the list of VisibleBlocks
  gpu::Buffer<shared::MapState> state;       // valid on the host between frames
  gpu::Buffer<shared::Transform> camera_from_submap;

 private:
  // As it lies in memory.
  struct Block {
    std::uint32_t number = 0;
    std::vector<shared::vec4> positions;
    std::vector<shared::SurfelAttributes> attributes;
    std::vector<shared::uvec2> times;
    shared::BlockBounds bounds;
    std::uint32_t changed_frame = 0;
    std::uint32_t moved_frame = 0;  // compact() has made or emptied it before that frame
    std::uint32_t alive_count = 0;
    std::uint32_t submap = 0;  // of those alive
  };
  // What a block is called, wherever it lies.
  struct Name {
    std::uint32_t number = 0, moved_frame = 0;
  };
  shared::MapState counters() const { return state.mapped()[0]; }
  std::uint32_t block_count() const { return (slot_count() + kSlotsPerBlock - 1) / kSlotsPerBlock; }
  Name name_of(std::uint32_t block) const;
  std::vector<Block> take_blocks();
  void replace_blocks(std::span<const Block> blocks);
  std::vector<Block> regrouped(const std::vector<Block>& sparse, std::uint32_t frame_number);
  static Block empty_block(const Name& name);
  static std::vector<Surfel> surfels_of(const Block& block);
  void download_blocks(std::uint32_t first, std::uint32_t count, std::vector<Block>& blocks) const;
  void upload_blocks(std::span<const Block> blocks);
  void clear_blocks(std::uint32_t first, std::uint32_t count);
  // surfel_store_state.cpp
  struct OnDevice;
  template <class Bytes, class Saved>
  static void block_fields(Bytes& bytes, Saved& block);
  template <class Bytes, class Saved>
  static void name_fields(Bytes& bytes, Saved& store);
  static void describe(Block& block);
  static void check(ByteReader& bytes, const OnDevice& saved, std::size_t submap_count);
  static void read_host_blocks(ByteReader& bytes, std::size_t submap_count, std::map<std::uint32_t, std::vector<Block>>& host_blocks);
  void check_numbers(ByteReader& bytes, std::size_t blocks_on_device) const;

  gpu::Device& device_;
  const std::uint32_t max_slots_;
  std::uint32_t capacity_ = 0;
  // By block on the device; those behind them, which have come since the map was rearranged, have next_number_ and so on.
  std::vector<Name> names_;
  std::uint32_t next_number_ = 0;
  std::vector<Name> gone_blocks_;                            // their surfels are elsewhere since
  std::map<std::uint32_t, std::vector<Block>> host_blocks_;  // by submap
  std::vector<Rigid3> world_from_submap_;
};

}  // namespace hermite
