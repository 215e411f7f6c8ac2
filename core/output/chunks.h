// Cuts a growing model into chunks that a viewer can replace one by one, and encodes them with Draco.
//
// A chunk is the part of one submap inside a cube of kChunkEdge_m, in the submap's frame. It keeps at most one point (the most confident, then the
// lowest slot) per voxel of kVoxelEdge_m. Memory: one small entry a live slot. Not thread-safe; one owner.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

inline constexpr float kVoxelEdge_m = 0.005f;
inline constexpr float kChunkEdge_m = 0.32f;  // 64 voxels
inline constexpr std::uint32_t kMaxPointsPerChunk = 262144;

struct ChunkKey {
  std::uint32_t submap = 0;
  std::uint8_t level = 0;  // 0 is the finest
  std::int16_t x = 0, y = 0, z = 0;
  auto operator<=>(const ChunkKey&) const = default;
};

// Draco, sequential, Morton order: POSITION (explicit grid of 1/8 voxel from the chunk's corner), COLOR u8x3, NORMAL 8 bit, GENERIC u8 confidence.
struct EncodedChunk {
  ChunkKey key;
  std::uint32_t point_count = 0;  // 0: the chunk is now empty and `draco` too
  std::string draco;
};

class ChunkedModel {
 public:
  // Points that are not finite or lie beyond the range of the key are left out and counted.
  void apply(std::span<const SlotChange> changes);

  // Keys touched since the last call, in order.
  std::vector<ChunkKey> take_dirty();

  // Deterministic: equal content gives equal bytes. kUnsupported in words when Draco refuses.
  Result<EncodedChunk> encode(const ChunkKey& key) const;

  std::uint64_t rejected_point_count() const { return rejected_point_count_; }

 private:
  struct Entry {
    ChunkKey key;
    CloudPoint point;
  };
  std::map<ChunkKey, std::set<std::uint32_t>> slots_by_chunk_;
  std::vector<std::unique_ptr<Entry>> entries_;  // by slot
  std::set<ChunkKey> dirty_;
  std::uint64_t rejected_point_count_ = 0;
};

}  // namespace hermite
