// Blends the colours of a chart's texels from the views that see them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/chart_raster.h"
#include "core/texture/texture_view.h"

namespace hermite::texture {

struct BlendOptions {
  int blended_views = 4;
};

// The weight of a view in a texel is the margin by which it sees the texel better (quality_of) than
// the best view that is not blended: it starts at zero, so that there is no seam where the ranking
// of the views changes. Views whose colour is far from the mean of all views of the texel, because
// of motion or a reflection, get little weight. Texels that no view sees get the vertex colour plus
// the interpolated difference of the texels around; the gutter extends the texels beside it. Const
// functions are thread-safe; the arguments must outlive this object.
class TexelBlender {
 public:
  TexelBlender(const output::TriangleMesh& mesh, const Camera& camera,
               const std::vector<TextureView>& views, const BlendOptions& options);

  // Returns an image of the chart's size.
  ColorImage blended(const FlatChart& chart) const;

 private:
  struct Texel;
  // Returns the views that see any of the points, best first.
  std::vector<std::uint32_t> views_of(const std::vector<ChartPoint>& points, float texel_m) const;
  bool blend(const ChartPoint& point, const std::vector<std::uint32_t>& views, float texel_m,
             Eigen::Vector3f& color) const;
  // By texel of a chart: the vertex colour, the difference of the views' colour from it, and
  // whether any view sees it.
  struct Blended {
    Image<Eigen::Vector3f> of_vertices, off_vertices;
    Image<std::uint8_t> is_seen;
  };
  void blend_tile(const FlatChart& chart, const ChartRaster& raster, int tile_x, int tile_y,
                  Blended& blended) const;

  const output::TriangleMesh& mesh_;
  const Camera& camera_;
  const std::vector<TextureView>& views_;
  const BlendOptions options_;
};

}  // namespace hermite::texture
