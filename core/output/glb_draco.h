// One primitive of a GLB by Draco, for KHR_draco_mesh_compression. Deterministic.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/output/glb_parts.h"

namespace hermite {

// The steps of a decoded position are at most this wide: no vertex is moved by more than half of it on an axis.
inline constexpr float kDracoStep_m = 0.0002f;

// The cube in which all primitives of one mesh are quantised: vertices that they share stay together.
struct DracoGrid {
  std::array<float, 3> corner{};
  float edge = 0;  // greater than 0
  int bits = 0;    // 8 to 24: beyond 3 km, steps are wider than kDracoStep_m
};
DracoGrid draco_grid_of(const std::vector<GlbPart>& parts);

struct DracoPart {
  std::string bytes;
  // As decoded: points that are the same became one, triangles without an area are gone.
  std::size_t vertex_count = 0, triangle_count = 0;
  int position = 0, normal = 0, color = 0, texture_coordinate = 0;  // the attributes' unique ids, where there are such
};

// `texture_edge_px`: of the page, by which texture coordinates are rounded, to a quarter of a pixel. kUnsupported in Draco's words.
Result<DracoPart> encode_draco_part(const GlbPart& part, const DracoGrid& grid, int texture_edge_px);

}  // namespace hermite
