#include "core/texture/texture_blend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/texture/texture_fill.h"

namespace hermite::texture {

namespace {

using Eigen::Vector3f;

// Side of a tile of texels for which the candidate views are determined together: some centimetres.
constexpr int kTile_texels = 16;
// Texels of a tile, evenly distributed, for which visible views are determined.
constexpr int kAsked = 8;
// Most candidate views of a tile, from which each texel takes its few.
constexpr std::size_t kViewsPerTile = 14;
// Nearer to an edge than this, a pixel may have the colour of the background or foreground.
constexpr float kBlendEdge_px = 1.0f;
// Colours this far from the mean have half the weight.
constexpr float kOutlierDifference = 20;

struct TexelCandidate {
  float quality = 0;
  Vector3f color = Vector3f::Zero();
};

// Returns the weighted mean; colours far from it get less weight in the second and third iteration.
Vector3f robust_mean(const std::array<TexelCandidate, kViewsPerTile>& candidates,
                     std::size_t count) {
  Vector3f mean = Vector3f::Zero();
  for (int round = 0; round < 3; ++round) {
    Vector3f sum = Vector3f::Zero();
    float all = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float off = round == 0 ? 0 : (candidates[i].color - mean).norm() / kOutlierDifference;
      const float weight = candidates[i].quality / (1 + off * off);
      sum += weight * candidates[i].color;
      all += weight;
    }
    mean = sum / all;
  }
  return mean;
}

Rgb8 rounded(const Vector3f& color) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
  };
  return {byte(color.x()), byte(color.y()), byte(color.z())};
}

}  // namespace

TexelBlender::TexelBlender(const output::TriangleMesh& mesh, const Camera& camera,
                           const std::vector<TextureView>& views, const BlendOptions& options)
    : mesh_(mesh), camera_(camera), views_(views), options_(options) {}

std::vector<std::uint32_t> TexelBlender::views_of(const std::vector<ChartPoint>& points,
                                                  float texel_m) const {
  std::vector<std::pair<float, std::uint32_t>> by_quality;
  for (std::uint32_t i = 0; i < views_.size(); ++i) {
    float best = 0;
    for (const ChartPoint& point : points)
      if (const std::optional<Seen> seen =
              seen_at(views_[i], camera_, point.position_m, point.normal, kBlendEdge_px))
        best = std::max(best, quality_of(views_[i], camera_, *seen, texel_m));
    if (best > 0) by_quality.emplace_back(-best, i);
  }
  std::sort(by_quality.begin(), by_quality.end());
  if (by_quality.size() > kViewsPerTile) by_quality.resize(kViewsPerTile);
  std::vector<std::uint32_t> views;
  for (const auto& [quality, view] : by_quality) views.push_back(view);
  return views;
}

bool TexelBlender::blend(const ChartPoint& point, const std::vector<std::uint32_t>& views,
                         float texel_m, Vector3f& color) const {
  std::array<TexelCandidate, kViewsPerTile> candidates;
  std::size_t count = 0;
  for (const std::uint32_t view : views) {
    const std::optional<Seen> seen =
        seen_at(views_[view], camera_, point.position_m, point.normal, kBlendEdge_px);
    if (!seen) continue;
    const float quality = quality_of(views_[view], camera_, *seen, texel_m);
    if (quality > 0) candidates[count++] = {quality, color_at(views_[view], seen->u, seen->v)};
  }
  if (count == 0) return false;
  const Vector3f mean = robust_mean(candidates, count);
  for (std::size_t i = 0; i < count; ++i) {
    const float off = (candidates[i].color - mean).norm() / kOutlierDifference;
    candidates[i].quality /= 1 + off * off;
  }
  std::stable_sort(
      candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
      [](const TexelCandidate& a, const TexelCandidate& b) { return a.quality > b.quality; });
  const std::size_t blended = std::min(count, static_cast<std::size_t>(options_.blended_views));
  const float rest = count > blended ? candidates[blended].quality : 0;
  Vector3f sum = Vector3f::Zero();
  float all = 0;
  for (std::size_t i = 0; i < blended; ++i) {
    const float weight = candidates[i].quality - rest + 1e-6f * candidates[0].quality;
    sum += weight * candidates[i].color;
    all += weight;
  }
  color = sum / all;
  return true;
}

void TexelBlender::blend_tile(const FlatChart& chart, const ChartRaster& raster, int tile_x,
                              int tile_y, Blended& blended) const {
  struct TexelPlace {
    int x, y;
  };
  std::vector<TexelPlace> places;
  std::vector<ChartPoint> points;
  for (int y = tile_y; y < std::min(tile_y + kTile_texels, chart.height); ++y)
    for (int x = tile_x; x < std::min(tile_x + kTile_texels, chart.width); ++x) {
      if (raster.triangle.at(x, y) == kNoTexel) continue;
      places.push_back({x, y});
      points.push_back(point_at(mesh_, chart, raster.triangle.at(x, y), x, y));
    }
  if (points.empty()) return;
  std::vector<ChartPoint> asked;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kAsked); ++i)
    asked.push_back(points[(points.size() - 1) * i / static_cast<std::size_t>(kAsked - 1)]);
  const std::vector<std::uint32_t> views = views_of(asked, chart.texel_m);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [x, y] = places[i];
    blended.of_vertices.at(x, y) = points[i].color;
    Vector3f color;
    if (!blend(points[i], views, chart.texel_m, color)) continue;
    blended.off_vertices.at(x, y) = color - points[i].color;
    blended.is_seen.at(x, y) = 1;
  }
}

ColorImage TexelBlender::blended(const FlatChart& chart) const {
  const ChartRaster raster = raster_of(mesh_, chart);
  Blended blended{Image<Vector3f>(chart.width, chart.height),
                  Image<Vector3f>(chart.width, chart.height),
                  Image<std::uint8_t>(chart.width, chart.height)};
  auto& [of_vertices, off_vertices, is_seen] = blended;
  Image<std::uint8_t> is_surface(chart.width, chart.height);
  std::fill(of_vertices.pixels.begin(), of_vertices.pixels.end(), Vector3f(Vector3f::Zero()));
  off_vertices.pixels = of_vertices.pixels;
  for (int y = 0; y < chart.height; y += kTile_texels)
    for (int x = 0; x < chart.width; x += kTile_texels) blend_tile(chart, raster, x, y, blended);
  fill_smoothly(off_vertices, is_seen);
  for (std::size_t i = 0; i < is_surface.pixels.size(); ++i) {
    is_surface.pixels[i] = raster.triangle.pixels[i] != kNoTexel ? 1 : 0;
    off_vertices.pixels[i] += of_vertices.pixels[i];
  }
  fill_smoothly(off_vertices, is_surface);
  ColorImage image(chart.width, chart.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = rounded(off_vertices.pixels[i]);
  return image;
}

}  // namespace hermite::texture
