// An atlas of a mesh: charts, each flat on a raster of its own, and their places on the pages.
//
// Why charts and not one small square for each quad of the dual contouring: cells of 1 cm with texels of 2 mm are 5 x 5 texels, 13 x 13
// with a gutter of 4 (15 % used), 7 x 7 with one of 1 (51 %), which bleeds at the first smaller picture of it that a viewer makes. Each
// quad has four vertices of its own, and simplified meshes have no quads.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/atlas_packing.h"
#include "core/texture/chart_raster.h"
#include "core/texture/texture_options.h"

namespace hermite {

struct Atlas {
  std::vector<FlatChart> charts;
  std::vector<RectanglePlace> places;  // by chart
  std::vector<RectangleSize> pages;
  double texel_m = 0;  // the largest: as asked for, or larger where the pages would not have sufficed
};

// Charts that were seen more finely have smaller texels: kTexelsOfPixel of what a pixel covers at the best quarter of the chart's vertices
// (finest_pixels_m of texture_detail.h, by vertex), and no less than kSmallestShare of the largest. Half a pixel is as far apart as samples
// may lie (Nyquist), so that the texture is hardly less sharp than the view it is from. kTooLarge: not even texels of kLargestTexel_m fit;
// kBusy: stopped.
inline constexpr double kLargestTexel_m = 0.2;
inline constexpr float kTexelsOfPixel = 0.5f, kSmallestShare = 0.25f;
Result<Atlas> atlas_of(const TriangleMesh& mesh, const std::vector<float>& finest_pixel_m, const TextureOptions& options);

// The mesh with its triangles in the order of pages and charts, a vertex for each chart that it is in, and texture coordinates. Pages are
// of their size and black. Vertices that no triangle has are left out.
TriangleMesh laid_out(const TriangleMesh& mesh, const Atlas& atlas);

}  // namespace hermite
