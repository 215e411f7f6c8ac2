// Encodes one primitive of a GLB with Draco, for KHR_draco_mesh_compression. Deterministic.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/output/glb_parts.h"

namespace hermite::output {

// The largest step of decoded positions: a vertex moves by at most half of it on each axis.
inline constexpr float kDracoStep_m = 0.0002f;

// The cube in which all primitives of one mesh are quantised, so that shared vertices stay
// together.
struct DracoGrid {
  std::array<float, 3> corner{};
  float edge = 0;  // above 0
  int bits = 0;    // 8 to 24; above 3 km, steps are wider than kDracoStep_m
};
DracoGrid draco_grid_of(const std::vector<GlbPart>& parts);

struct DracoPart {
  std::string bytes;
  // Counts after encoding: identical points were merged and degenerate triangles removed.
  std::size_t vertex_count = 0, triangle_count = 0;
  // Unique ids of the attributes that exist.
  int position = 0, normal = 0, color = 0, texture_coordinate = 0;
};

// `texture_edge_px` is the edge of the page; texture coordinates are rounded to a quarter of its
// pixel. Returns kUnsupported with Draco's message when Draco fails.
Result<DracoPart> encode_draco_part(const GlbPart& part, const DracoGrid& grid,
                                    int texture_edge_px);

}  // namespace hermite::output
