// Cuts a growing model into chunks that a viewer can replace one by one, and encodes them with
// Draco.
//
// A chunk contains the points of one submap inside a cube of kChunkEdge_m, in the submap's frame:
// chunk (x, y, z) spans from x * kChunkEdge_m to (x + 1) * kChunkEdge_m, exclusive. It keeps at
// most one point per voxel of kVoxelEdge_m: the most confident one, then the one with the lowest
// slot. At level L, which is for models larger than a scan, all these lengths are 2^L times as
// long.
// Memory: about 40 bytes per slot, up to the highest slot ever used. Not thread-safe; one owner.
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

namespace hermite::output {

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

// Draco with sequential encoding in Morton order: POSITION float x3 (on a grid of 1/8 voxel, so
// within 1/16 voxel of the true position on each axis), COLOR u8 x3, NORMAL float x3 (octahedral, 8
// bit; absent if no point of the chunk has one), GENERIC u8 (eighths_of_confidence).
struct EncodedChunk {
  ChunkKey key;
  std::uint32_t point_count = 0;  // 0: the chunk is now empty and `draco` too
  std::string draco;
};

class ChunkedModel {
 public:
  // `level` is at most kCoarsestLevel (CHECK). Points with less confidence than `least_confidence`
  // are ignored.
  explicit ChunkedModel(std::uint8_t level = 0,
                        double least_confidence = std::numeric_limits<double>::lowest());

  // Applies changes. Points with values that are not finite (position, normal, confidence) or
  // beyond the range of the key are dropped and counted, and their slot becomes empty. Slots must
  // be below kMaxModelSlots (CHECK).
  void apply(std::span<const SlotChange> changes);

  // Returns the keys changed since the last call, in order. Setting a slot to its present content
  // changes nothing.
  std::vector<ChunkKey> take_dirty();

  // Encodes a chunk; a key without points gives an empty one. Deterministic: equal content gives
  // equal bytes, whatever its history. Returns kUnsupported with Draco's message when Draco fails.
  Result<EncodedChunk> encode(const ChunkKey& key) const;

  std::uint64_t rejected_point_count() const { return rejected_point_count_; }

 private:
  // The attributes of a point that its chunk contains. `place` is its index among the slots of the
  // chunk.
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
    std::vector<std::uint32_t> slots;  // unordered
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
  std::vector<Entry> entries_;  // by slot
  // Includes chunks that are now empty.
  std::vector<Chunk> chunks_;
  std::unordered_map<ChunkKey, std::uint32_t, KeyHash> chunk_by_key_;  // indices into chunks_
  std::vector<std::uint32_t> dirty_;                                   // indices into chunks_
  std::uint64_t rejected_point_count_ = 0;
};

}  // namespace hermite::output
