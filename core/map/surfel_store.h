// The surfels of a map in GPU memory: three arrays of 40 bytes a slot in all, a list of free slots, bounds of blocks of slots, and the
// poses of submaps.
//
// A surfel's position and normal are in the frame of its submap. A slot keeps its number while its surfel lives and is used again
// afterwards. All surfels of a block are of one submap. One thread at a time: the device's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/math/rigid3.h"
#include "shaders/shared/map.h"

namespace hermite {

inline constexpr std::uint32_t kSlotsPerBlock = 256;
// As many blocks as every device can dispatch at once.
inline constexpr std::uint32_t kMaxSlots = 65535 * kSlotsPerBlock;
inline constexpr std::uint32_t kMaxSubmaps = 1u << 16;  // a surfel has 16 bits for its own

// By submap: is it one of them?
using SubmapSet = std::vector<bool>;

struct Surfel {
  Eigen::Vector3f position_in_submap_m;
  Eigen::Vector3f normal_in_submap;  // unit, away from the camera that saw it
  float radius_m = 0;
  float confidence = 0;  // 0: the slot is free
  float curvature_max_per_m = 0, curvature_min_per_m = 0;
  std::uint8_t r = 0, g = 0, b = 0;
  std::uint32_t submap = 0;
  std::uint32_t created_frame = 0, observed_frame = 0;
};

shared::Transform to_shared(const Rigid3& target_from_source);

// Of surfels in slots from the beginning of a block on; those without confidence do not count.
std::vector<shared::BlockBounds> bounds_of(std::span<const Surfel> surfels);

class SurfelStore {
 public:
  explicit SurfelStore(gpu::Device& device);

  // Room for `additional` more slots; grows by half, keeping the content. Throws gpu::DeviceError when the device has no more, or beyond
  // kMaxSlots.
  void reserve(std::uint32_t additional);

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

  gpu::Buffer<shared::vec4> positions;
  gpu::Buffer<shared::SurfelAttributes> attributes;
  gpu::Buffer<shared::uvec2> times;
  gpu::Buffer<shared::uint> free_slots;
  gpu::Buffer<shared::uint> group_counts;   // scratch of the prefix sums, one entry for every block
  gpu::Buffer<shared::BlockBounds> bounds;  // by block of 256 slots
  gpu::Buffer<shared::uint>
      visible_blocks;  // workgroups for a dispatch over all, and over those in turn (three words each), then the list of VisibleBlocks
  gpu::Buffer<shared::MapState> state;  // valid on the host between frames
  gpu::Buffer<shared::Transform> camera_from_submap;

 private:
  shared::MapState counters() const { return state.mapped()[0]; }

  gpu::Device& device_;
  std::uint32_t capacity_ = 0;
  std::vector<Rigid3> world_from_submap_;
};

}  // namespace hermite
