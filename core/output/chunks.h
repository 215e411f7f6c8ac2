// Cuts a growing model into chunks that a viewer can replace one by one, and encodes them with Draco.
//
// A chunk is the part of one submap inside a cube of kChunkEdge_m, in the submap's frame: chunk (x, y, z) spans x * kChunkEdge_m up to, not
// including, (x + 1) * kChunkEdge_m. It keeps at most one point (the most confident, then the lowest slot) per voxel of kVoxelEdge_m.
// At level L all of these lengths are 2^L times as long: for what is larger than a scan.
// Memory: about 40 bytes a slot, up to the highest slot ever used. Not thread-safe; one owner.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

inline constexpr float kVoxelEdge_m = 0.005f;
inline constexpr float kChunkEdge_m = 0.32f;  // 64 voxels
inline constexpr std::uint32_t kMaxPointsPerChunk = 262144;
inline constexpr std::uint32_t kMaxModelSlots = 1u << 28;
inline constexpr std::uint8_t kCoarsestLevel = 12;  // voxels of 20 m

struct ChunkKey {
  std::uint32_t submap = 0;
  std::uint8_t level = 0;  // 0 is the finest
  std::int16_t x = 0, y = 0, z = 0;
  auto operator<=>(const ChunkKey&) const = default;
};

// Draco, sequential, Morton order: POSITION float x3 (on a grid of 1/8 voxel: within 1/16 voxel of the truth on each axis), COLOR u8 x3,
// NORMAL float x3 (octahedral, 8 bit; left out when no point of the chunk has one), GENERIC u8 (confidence times 8, rounded, at most 255).
struct EncodedChunk {
  ChunkKey key;
  std::uint32_t point_count = 0;  // 0: the chunk is now empty and `draco` too
  std::string draco;
};

class ChunkedModel {
 public:
  // `level`: at most kCoarsestLevel (CHECK). Points of less confidence than `least_confidence` are none.
  explicit ChunkedModel(std::uint8_t level = 0, double least_confidence = std::numeric_limits<double>::lowest());

  // Points that are not finite (position, normal, confidence) or lie beyond the range of the key are left out and counted; what their slot
  // held before is gone. Slots must be below kMaxModelSlots (CHECK).
  void apply(std::span<const SlotChange> changes);

  // Keys touched since the last call, in order. A slot that is set to what it already holds touches nothing.
  std::vector<ChunkKey> take_dirty();

  // Deterministic: equal content gives equal bytes, whatever the way it came about. A key without points gives an empty chunk.
  // kUnsupported in words when Draco refuses.
  Result<EncodedChunk> encode(const ChunkKey& key) const;

  std::uint64_t rejected_point_count() const { return rejected_point_count_; }

 private:
  // What a chunk shows of a point. `place` is its index among the slots of its chunk.
  struct Entry {
    Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
    float confidence = 0;
    std::array<std::int16_t, 3> normal{};  // times 32767
    Rgb8 color;
    bool alive = false;
    std::uint32_t chunk = 0;
    std::uint32_t place = 0;
  };
  struct Chunk {
    ChunkKey key;
    std::vector<std::uint32_t> slots;  // in no order
    bool dirty = false;
  };
  struct KeyHash {
    std::size_t operator()(const ChunkKey& key) const;
  };
  struct Candidate {
    std::uint32_t voxel = 0;  // Morton code
    std::uint32_t slot = 0;
  };

  static std::optional<Entry> compact(const CloudPoint& point);
  std::uint32_t chunk_index(const ChunkKey& key);
  void touch(std::uint32_t chunk);
  void set(std::uint32_t slot, const CloudPoint& point);
  void remove(std::uint32_t slot);
  std::vector<Candidate> visible_points(const Chunk& chunk) const;

  const std::uint8_t level_;
  const double least_confidence_;
  std::vector<Entry> entries_;                                         // by slot
  std::vector<Chunk> chunks_;                                          // also those that are empty by now
  std::unordered_map<ChunkKey, std::uint32_t, KeyHash> chunk_by_key_;  // into chunks_
  std::vector<std::uint32_t> dirty_;                                   // into chunks_
  std::uint64_t rejected_point_count_ = 0;
};

}  // namespace hermite
