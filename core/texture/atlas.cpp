#include "core/texture/atlas.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "core/base/parallel.h"

namespace hermite::texture {

namespace {

// The largest side of a chart; smaller charts pack better.
constexpr int kLongestChart_texels = 1024;
// After this many rounds, triangles that still overlap become charts of their own.
constexpr int kOverlapRounds = 8;
constexpr double kCoarser = 1.1892;  // texels of twice the size after four steps

int longest_chart_texels(const TextureOptions& options) {
  return std::min(kLongestChart_texels, options.page_px / 2);
}

Chart chart_of_one(const output::TriangleMesh& mesh, std::uint32_t triangle) {
  const output::TriangleCorners& t = mesh.triangles[triangle];
  const Eigen::Vector3f& a = mesh.positions_m[t[0]];
  const Eigen::Vector3f cross = (mesh.positions_m[t[1]] - a).cross(mesh.positions_m[t[2]] - a);
  return {{triangle},
          cross.norm() > 0 ? Eigen::Vector3f(cross.normalized())
                           : Eigen::Vector3f(Eigen::Vector3f::UnitZ())};
}

// Returns the texel size of a chart as a share of the largest texel.
float share_of_texel(const output::TriangleMesh& mesh, const Chart& chart,
                     const std::vector<float>& finest_pixel_m, double texel_m) {
  std::vector<float> pixels_m;
  pixels_m.reserve(3 * chart.triangles.size());
  for (const std::uint32_t triangle : chart.triangles)
    for (const std::uint32_t corner : mesh.triangles[triangle])
      pixels_m.push_back(finest_pixel_m[corner]);
  const auto quarter = pixels_m.begin() + static_cast<std::ptrdiff_t>(pixels_m.size() / 4);
  std::nth_element(pixels_m.begin(), quarter, pixels_m.end());
  return std::clamp(kTexelsOfPixel * *quarter / static_cast<float>(texel_m), kSmallestShare, 1.0f);
}

// Returns flattened charts without overlaps: triangles that would overlap others are grown into
// charts of their own.
std::vector<FlatChart> flat_charts(const output::TriangleMesh& mesh,
                                   const std::vector<float>& finest_pixel_m,
                                   const TextureOptions& options, double texel_m) {
  const int longest_fine_texels = std::min(2 * longest_chart_texels(options), options.page_px);
  ChartGrower grower(mesh, texel_m * (longest_chart_texels(options) - 2 * kGutter_texels - 1));
  std::vector<std::uint32_t> left(mesh.triangles.size());
  std::iota(left.begin(), left.end(), 0u);
  std::vector<FlatChart> finished;
  for (int round = 0; !left.empty(); ++round) {
    std::vector<Chart> charts;
    if (round < kOverlapRounds)
      charts = grower.grow(left);
    else
      for (const std::uint32_t triangle : left) charts.push_back(chart_of_one(mesh, triangle));
    std::vector<FlatChart> flat(charts.size());
    std::vector<std::vector<std::uint32_t>> overlapping(charts.size());
    in_parallel(charts.size(), options.thread_count, [&](std::size_t i) {
      if (is_stopped(options)) return;
      if (charts[i].triangles.size() == 1) charts[i] = chart_of_one(mesh, charts[i].triangles[0]);
      const double own_texel_m =
          texel_m * static_cast<double>(share_of_texel(mesh, charts[i], finest_pixel_m, texel_m));
      const int longest = own_texel_m < texel_m ? longest_fine_texels : options.page_px;
      flat[i] = flattened(mesh, charts[i], own_texel_m, longest);
      overlapping[i] = raster_of(mesh, flat[i]).overlapping;
      if (overlapping[i].empty()) return;
      std::sort(overlapping[i].begin(), overlapping[i].end());
      std::erase_if(charts[i].triangles, [&](std::uint32_t triangle) {
        return std::binary_search(overlapping[i].begin(), overlapping[i].end(), triangle);
      });
      if (!charts[i].triangles.empty()) flat[i] = flattened(mesh, charts[i], own_texel_m, longest);
    });
    left.clear();
    for (std::size_t i = 0; i < charts.size(); ++i) {
      if (!charts[i].triangles.empty()) finished.push_back(std::move(flat[i]));
      left.insert(left.end(), overlapping[i].begin(), overlapping[i].end());
    }
    std::sort(left.begin(), left.end());
  }
  return finished;
}

std::vector<RectangleSize> sizes_of(const std::vector<FlatChart>& charts) {
  std::vector<RectangleSize> sizes;
  for (const FlatChart& chart : charts) sizes.push_back({chart.width, chart.height});
  return sizes;
}

double area_m2(const output::TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += static_cast<double>((mesh.positions_m[b] - mesh.positions_m[a])
                                   .cross(mesh.positions_m[c] - mesh.positions_m[a])
                                   .norm()) /
           2;
  return sum;
}

}  // namespace

Result<Atlas> atlas_of(const output::TriangleMesh& mesh, const std::vector<float>& finest_pixel_m,
                       const TextureOptions& options) {
  Atlas atlas;
  // No packing fills its pages completely, so texel sizes that would need the whole area are not
  // tried.
  const double room = static_cast<double>(options.page_px) * options.page_px * options.max_pages;
  atlas.texel_m = std::max(options.texel_m, std::sqrt(area_m2(mesh) / room));
  for (; atlas.texel_m <= kLargestTexel_m; atlas.texel_m *= kCoarser) {
    std::vector<FlatChart> charts = flat_charts(mesh, finest_pixel_m, options, atlas.texel_m);
    if (is_stopped(options)) return Error{ErrorCode::kBusy, "texturing was stopped"};
    std::optional<Packing> packing = packed(sizes_of(charts), options.page_px, options.max_pages);
    if (!packing) continue;
    atlas.charts = std::move(charts);
    atlas.places = std::move(packing->places);
    atlas.pages = std::move(packing->pages);
    return atlas;
  }
  return Error{
      ErrorCode::kTooLarge,
      fmt::format("the surface of {} m^2 in {} triangles does not fit {} pages of {} pixels",
                  std::llround(area_m2(mesh)), mesh.triangles.size(), options.max_pages,
                  options.page_px)};
}

output::TriangleMesh laid_out(const output::TriangleMesh& mesh, const Atlas& atlas) {
  output::TriangleMesh result;
  result.triangles.reserve(mesh.triangles.size());
  for (const RectangleSize& page : atlas.pages)
    result.pages.push_back({ColorImage(page.width, page.height), 0, 0});
  std::vector<std::vector<std::size_t>> charts_by_page(atlas.pages.size());
  for (std::size_t i = 0; i < atlas.charts.size(); ++i)
    charts_by_page[static_cast<std::size_t>(atlas.places[i].page)].push_back(i);
  constexpr std::uint32_t kNotYet = 0xffffffff;
  std::vector<std::uint32_t> vertex_in_chart(mesh.positions_m.size(), kNotYet);
  for (std::size_t page = 0; page < result.pages.size(); ++page) {
    result.pages[page].first_triangle = static_cast<std::uint32_t>(result.triangles.size());
    const Eigen::Vector2f side(static_cast<float>(atlas.pages[page].width),
                               static_cast<float>(atlas.pages[page].height));
    for (const std::size_t i : charts_by_page[page]) {
      const FlatChart& chart = atlas.charts[i];
      const Eigen::Vector2f corner(static_cast<float>(atlas.places[i].x),
                                   static_cast<float>(atlas.places[i].y));
      for (const std::uint32_t triangle : chart.triangles) {
        output::TriangleCorners corners;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t old = mesh.triangles[triangle][k];
          if (vertex_in_chart[old] == kNotYet) {
            vertex_in_chart[old] = static_cast<std::uint32_t>(result.positions_m.size());
            result.positions_m.push_back(mesh.positions_m[old]);
            result.normals.push_back(mesh.normals[old]);
            result.colors.push_back(mesh.colors[old]);
            result.texture_coordinates.push_back(
                (chart.at(mesh.positions_m[old]) + corner).cwiseQuotient(side));
          }
          corners[k] = vertex_in_chart[old];
        }
        result.triangles.push_back(corners);
        if (!mesh.is_filled.empty()) result.is_filled.push_back(mesh.is_filled[triangle]);
      }
      for (const std::uint32_t triangle : chart.triangles)
        for (const std::uint32_t old : mesh.triangles[triangle]) vertex_in_chart[old] = kNotYet;
    }
    result.pages[page].triangle_count =
        static_cast<std::uint32_t>(result.triangles.size()) - result.pages[page].first_triangle;
  }
  return result;
}

}  // namespace hermite::texture
