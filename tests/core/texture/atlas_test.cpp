#include "core/texture/atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/texture/texture_detail.h"
#include "tests/core/texture/texture_scene.h"
#include "tests/support/analytic_mesh.h"

namespace hermite::texture {
namespace {

TextureOptions atlas_options(double texel_m) {
  TextureOptions options;
  options.texel_m = texel_m;
  options.page_px = 512;
  options.thread_count = 2;
  return options;
}

std::vector<float> never_seen(const output::TriangleMesh& mesh) {
  return std::vector<float>(mesh.positions_m.size(), kNeverSeen_m);
}

// How many charts have each triangle.
std::vector<int> times_charted(const output::TriangleMesh& mesh, const Atlas& atlas) {
  std::vector<int> times(mesh.triangles.size(), 0);
  for (const FlatChart& chart : atlas.charts)
    for (const std::uint32_t triangle : chart.triangles) ++times[triangle];
  return times;
}

void expect_all_apart(const Atlas& atlas) {
  std::vector<Image<std::uint8_t>> pages;
  for (const RectangleSize& page : atlas.pages) pages.emplace_back(page.width, page.height);
  for (std::size_t i = 0; i < atlas.charts.size(); ++i) {
    const RectanglePlace& place = atlas.places[i];
    Image<std::uint8_t>& page = pages[static_cast<std::size_t>(place.page)];
    ASSERT_LE(place.x + atlas.charts[i].width, page.width);
    ASSERT_LE(place.y + atlas.charts[i].height, page.height);
    for (int y = 0; y < atlas.charts[i].height; ++y)
      for (int x = 0; x < atlas.charts[i].width; ++x)
        ASSERT_EQ(page.at(place.x + x, place.y + y)++, 0) << "chart " << i;
  }
}

TEST(Atlas, HasEveryTriangleOfASphereOnceAndNoTwoChartsOnOneTexel) {
  const output::TriangleMesh sphere = test::sphere_mesh(20, 40);
  const Result<Atlas> atlas = atlas_of(sphere, never_seen(sphere), atlas_options(0.01));
  ASSERT_TRUE(atlas.ok()) << atlas.error().message;
  for (const int times : times_charted(sphere, *atlas)) EXPECT_EQ(times, 1);
  EXPECT_GE(atlas->charts.size(), 4u) << "within 45 degrees of a mean no fewer cover a sphere";
  EXPECT_LE(atlas->charts.size(), 60u);
  expect_all_apart(*atlas);
}

TEST(Atlas, OfACrumpledSurfaceHasEveryTriangleOnce) {
  output::TriangleMesh mesh = test::wall_mesh(24);
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i)
    mesh.positions_m[i].z() += 0.1f * static_cast<float>((i * 7919) % 13) / 13;
  const Result<Atlas> atlas = atlas_of(mesh, never_seen(mesh), atlas_options(0.01));
  ASSERT_TRUE(atlas.ok()) << atlas.error().message;
  for (const int times : times_charted(mesh, *atlas)) EXPECT_EQ(times, 1);
  expect_all_apart(*atlas);
}

// Two turns of a band that winds around an axis with a slow rise of its radius: seen from outside
// it lies on itself, though neighbours hardly turn. Here a sheet folded to an S, whose middle layer
// the charts must not share.
TEST(Atlas, NoTriangleOfAChartLiesOnAnotherOfIt) {
  output::TriangleMesh mesh;
  constexpr std::uint32_t kSteps = 60;
  for (std::uint32_t i = 0; i <= kSteps; ++i)
    for (const float height : {0.0f, 0.05f}) {
      // A ramp that goes round twice: all of it looks up, its second turn lies above the first.
      const float angle = static_cast<float>(i) * 12.566f / kSteps,
                  rise = static_cast<float>(i) * 0.002f;
      const float radius = 0.2f + 2 * height;
      mesh.positions_m.push_back({radius * std::cos(angle), radius * std::sin(angle), rise});
      mesh.normals.push_back({0, 0, 1});
      mesh.colors.push_back({});
    }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  const Result<Atlas> atlas = atlas_of(mesh, never_seen(mesh), atlas_options(0.005));
  ASSERT_TRUE(atlas.ok()) << atlas.error().message;
  EXPECT_GE(atlas->charts.size(), 2u);
  for (const int times : times_charted(mesh, *atlas)) EXPECT_EQ(times, 1);
  for (const FlatChart& chart : atlas->charts)
    EXPECT_TRUE(raster_of(mesh, chart).overlapping.empty());
}

TEST(Atlas, KeepsAGutterAroundEveryChart) {
  const output::TriangleMesh sphere = test::sphere_mesh(12, 24);
  const Result<Atlas> atlas = atlas_of(sphere, never_seen(sphere), atlas_options(0.01));
  ASSERT_TRUE(atlas.ok());
  for (const FlatChart& chart : atlas->charts)
    for (const std::uint32_t triangle : chart.triangles)
      for (const std::uint32_t corner : sphere.triangles[triangle]) {
        const Eigen::Vector2f at = chart.at(sphere.positions_m[corner]);
        EXPECT_GE(at.minCoeff(), kGutter_texels - 0.01f);
        EXPECT_LE(at.x(), static_cast<float>(chart.width - kGutter_texels) + 0.01f);
        EXPECT_LE(at.y(), static_cast<float>(chart.height - kGutter_texels) + 0.01f);
      }
}

TEST(Atlas, TakesLargerTexelsWhereThePagesWouldNotSuffice) {
  TextureOptions options = atlas_options(0.001);
  options.max_pages = 1;  // 2 x 2 m on 512 x 512
  const Result<Atlas> atlas = atlas_of(test::wall_mesh(), never_seen(test::wall_mesh()), options);
  ASSERT_TRUE(atlas.ok()) << atlas.error().message;
  EXPECT_EQ(atlas->pages.size(), 1u);
  EXPECT_GT(atlas->texel_m, 0.0038);
  EXPECT_LT(atlas->texel_m, 0.012);
}

TEST(Atlas, LaysOutTheSameSurface) {
  const output::TriangleMesh sphere = test::sphere_mesh(12, 24);
  const Result<Atlas> atlas = atlas_of(sphere, never_seen(sphere), atlas_options(0.01));
  ASSERT_TRUE(atlas.ok());
  const output::TriangleMesh laid = laid_out(sphere, *atlas);
  const auto corners = [](const output::TriangleMesh& mesh) {
    std::multiset<std::vector<float>> all;
    for (const output::TriangleCorners& t : mesh.triangles) {
      std::vector<float> numbers;
      for (const std::uint32_t corner : t)
        numbers.insert(numbers.end(), mesh.positions_m[corner].data(),
                       mesh.positions_m[corner].data() + 3);
      all.insert(numbers);
    }
    return all;
  };
  EXPECT_EQ(corners(laid), corners(sphere));
  ASSERT_EQ(laid.texture_coordinates.size(), laid.positions_m.size());
  for (const Eigen::Vector2f& at : laid.texture_coordinates)
    EXPECT_TRUE(at.minCoeff() > 0 && at.maxCoeff() < 1) << at.transpose();
}

TEST(Packing, PutsRectanglesBesideEachOtherAndSaysWhenThereIsNoRoom) {
  std::vector<RectangleSize> sizes;
  for (int i = 0; i < 200; ++i) sizes.push_back({5 + (i * 37) % 50, 5 + (i * 53) % 40});
  const std::optional<Packing> packing = packed(sizes, 256, 8);
  ASSERT_TRUE(packing);
  double area = 0, pages = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    area += sizes[i].width * sizes[i].height;
    for (std::size_t k = 0; k < i; ++k) {
      const RectanglePlace &a = packing->places[i], &b = packing->places[k];
      EXPECT_FALSE(a.page == b.page && a.x < b.x + sizes[k].width && b.x < a.x + sizes[i].width &&
                   a.y < b.y + sizes[k].height && b.y < a.y + sizes[i].height)
          << i << " lies on " << k;
    }
  }
  for (const RectangleSize& page : packing->pages) pages += page.width * page.height;
  EXPECT_GT(area / pages, 0.75);
  EXPECT_FALSE(packed(sizes, 256, 1));
}

}  // namespace
}  // namespace hermite::texture
