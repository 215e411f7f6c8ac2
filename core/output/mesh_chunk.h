// A piece of a growing surface, small and soon made, for viewers. Deterministic, pure.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

// What a viewer takes of one piece. A cube of 32^3 cells that surface runs through in every cell has as many triangles.
inline constexpr std::uint32_t kMaxTrianglesPerChunk = 262144;

// Draco: POSITION float x3, NORMAL float x3 (octahedral, 8 bit), COLOR u8 x3. Positions lie on a grid through the origin whose steps are
// kMeshChunkStep_cells of a cell: a vertex that two pieces in one frame share is the same in both, to a rounding of float.
struct EncodedMesh {
  std::uint32_t triangle_count = 0;  // 0: nothing is left, and `draco` is empty
  std::string draco;
};
inline constexpr double kMeshChunkStep_cells = 1.0 / 32;

// Of a mesh without a texture, of any size up to 2^20 steps. kTooLarge: beyond that or kMaxTrianglesPerChunk; kUnsupported in Draco's
// words.
Result<EncodedMesh> encode_mesh_chunk(const TriangleMesh& mesh, double cell_m);

}  // namespace hermite
