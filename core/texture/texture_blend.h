// The colour of a chart's texels, from the views that see them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/chart_raster.h"
#include "core/texture/texture_view.h"

namespace hermite {

struct BlendOptions {
  int blended_views = 4;
};

// A view's part in a texel is by how much it sees it better (quality_of) than the best that has no part: it grows from nothing, so that
// there is no seam where the order of the views changes. Views whose colour is far from the mean of all that see the texel, because of
// something that moved or shone, have little. Texels that no view sees have the colour of the vertices and what the texels around are off
// from those; the gutter goes on from the texels beside it. Const functions are thread-safe; what the constructor is given must stay.
class TexelBlender {
 public:
  TexelBlender(const TriangleMesh& mesh, const Camera& camera, const std::vector<TextureView>& views, const BlendOptions& options);

  // Of the chart's size.
  ColorImage blended(const FlatChart& chart) const;

 private:
  struct Texel;
  // Views that see something of the points, best first.
  std::vector<std::uint32_t> views_of(const std::vector<SurfacePoint>& points, float texel_m) const;
  bool blend(const SurfacePoint& point, const std::vector<std::uint32_t>& views, float texel_m, Eigen::Vector3f& color) const;
  // By texel of a chart: the colour of the mesh there, how far that of the views is off it, and whether there is one.
  struct Blended {
    Image<Eigen::Vector3f> of_vertices, off_vertices;
    Image<std::uint8_t> is_seen;
  };
  void blend_tile(const FlatChart& chart, const ChartRaster& raster, int tile_x, int tile_y, Blended& blended) const;

  const TriangleMesh& mesh_;
  const Camera& camera_;
  const std::vector<TextureView>& views_;
  const BlendOptions options_;
};

}  // namespace hermite
