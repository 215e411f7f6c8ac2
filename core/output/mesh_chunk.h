// Encodes a piece of a growing surface for viewers, small and fast. Deterministic, pure.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

// The largest piece that a viewer accepts: the number of triangles of a cube of 32^3 cells with
// surface in every cell.
inline constexpr std::uint32_t kMaxTrianglesPerChunk = 262144;

// Draco, with unique ids in this order: POSITION float x3, NORMAL float x3 (octahedral, 8 bit),
// COLOR u8 x3, and of a mesh with confidences GENERIC u8 (eighths_of_confidence). Positions lie on
// a grid through the origin with steps of kMeshChunkStep_cells of a cell, so a vertex shared by two
// pieces in one frame is the same in both, up to float rounding.
struct EncodedMesh {
  std::uint32_t triangle_count = 0;  // 0: the piece is now empty, and so is `draco`
  std::string draco;
};
inline constexpr double kMeshChunkStep_cells = 1.0 / 32;

// Encodes a mesh without a texture. Returns kTooLarge above 2^20 steps or kMaxTrianglesPerChunk,
// and kUnsupported with Draco's message when Draco fails.
Result<EncodedMesh> encode_mesh_chunk(const TriangleMesh& mesh, double cell_m);

}  // namespace hermite::output
