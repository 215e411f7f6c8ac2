// The chunks of a finished scan on disk, so that a later viewer gets what a viewer of the running
// scan got. Little endian:
//
//   "HRMCHNK1"
//   u32 submap_count, then for each: u32 submap, f64 tx ty tz qx qy qz qw (world_from_submap)
//   u32 chunk_count, then for each: u32 submap, u8 level, i16 x y z, u32 point_count, u32
//       byte_count, bytes (Draco)
//
// Nothing may follow. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/math/rigid3.h"
#include "core/output/chunks.h"

namespace hermite::server {

inline constexpr const char* kChunksName = "chunks.bin";  // name of the blob

struct StoredSubmap {
  std::uint32_t submap = 0;
  Rigid3 world_from_submap;
};

struct StoredChunks {
  std::vector<StoredSubmap> submaps;
  std::vector<output::EncodedChunk> chunks;
};

std::string format_chunk_file(const StoredChunks& stored);

// kCorruptData, naming what is wrong: the magic, a length that exceeds the file, bytes after the
// end, an invalid pose, more than kMaxPointsPerChunk points.
Result<StoredChunks> parse_chunk_file(std::string_view bytes);

}  // namespace hermite::server
