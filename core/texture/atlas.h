// The texture atlas of a mesh: charts, each flattened onto a raster, and their positions on the
// texture pages.
//
// Why charts rather than one small square for each quad of dual contouring: with cells of 1 cm and
// texels of 2 mm a quad has 5 x 5 texels. With a gutter of 4 that becomes 13 x 13 (15 % used); with
// a gutter of 1 it is 7 x 7 (51 %), but colours bleed in the first mipmap of a viewer. Besides,
// each quad would need four vertices of its own, and simplified meshes have no quads.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/atlas_packing.h"
#include "core/texture/chart_raster.h"
#include "core/texture/texture_options.h"

namespace hermite::texture {

struct Atlas {
  std::vector<FlatChart> charts;
  std::vector<RectanglePlace> places;  // by chart
  std::vector<RectangleSize> pages;
  // The largest texel: as requested, or larger when the pages would not suffice.
  double texel_m = 0;
};

// The mesh is too large for a texture if it needs coarser texels than this.
inline constexpr double kLargestTexel_m = 0.2;
// Size of a chart's texels relative to the pixels of the views that show it best, and their least
// size relative to the largest texels.
inline constexpr float kTexelsOfPixel = 0.5f, kSmallestShare = 0.25f;

// Returns the atlas. Charts that were seen at a finer resolution have smaller texels:
// kTexelsOfPixel times the size of a pixel on the surface at the best quarter of the chart's
// vertices (finest_pixels_m of texture_detail.h, by vertex), but at least kSmallestShare of the
// largest texel. Samples may be at most half a pixel apart (Nyquist), so that the texture is hardly
// less sharp than its views. kTooLarge when not even texels of kLargestTexel_m fit; kBusy when
// stopped.
Result<Atlas> atlas_of(const output::TriangleMesh& mesh, const std::vector<float>& finest_pixel_m,
                       const TextureOptions& options);

// Returns the mesh with texture coordinates: triangles sorted by page and chart, each vertex
// duplicated for every chart that uses it, and black pages of the right size. Unused vertices are
// left out.
output::TriangleMesh laid_out(const output::TriangleMesh& mesh, const Atlas& atlas);

}  // namespace hermite::texture
