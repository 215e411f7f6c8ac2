#include "core/texture/view_raster.h"

#include <gtest/gtest.h>

#include "core/texture/texture_view.h"
#include "tests/core/texture/texture_scene.h"

namespace hermite::texture {
namespace {

TEST(ViewRaster, HasTheDepthOfAPlane) {
  const ViewRaster raster = rasterised(test::wall_mesh(), test::small_camera(), {});
  // 2 m of wall at 2 m are 130 pixels.
  EXPECT_NEAR(raster.inverse_depth_per_m.at(80, 60), 0.5f, 1e-6);
  EXPECT_NEAR(raster.inverse_depth_per_m.at(16, 10), 0.5f, 1e-6);
  EXPECT_EQ(raster.inverse_depth_per_m.at(13, 60), 0.0f);
  EXPECT_EQ(raster.triangle.at(13, 60), kNoTriangle);
  for (int y = 0; y < 120; ++y)
    for (int x = 16; x < 144; ++x)
      EXPECT_NE(raster.triangle.at(x, y), kNoTriangle) << "a crack at " << x << ", " << y;
}

TEST(ViewRaster, CutsWhatReachesBehindTheCamera) {
  output::TriangleMesh mesh;  // a floor 1 m below, from behind the camera to far before it
  mesh.positions_m = {{-50, 1, -10}, {50, 1, -10}, {0, 1, 100}};
  mesh.normals.assign(3, {0, -1, 0});
  mesh.colors.resize(3);
  mesh.triangles = {{0, 1, 2}};
  const ViewRaster raster = rasterised(mesh, test::small_camera(), {});
  EXPECT_NEAR(raster.inverse_depth_per_m.at(80, 110), (110 - 59.5) / 130, 1e-5)
      << "z = fy * 1 m / (v - cy)";
  EXPECT_EQ(raster.inverse_depth_per_m.at(80, 30), 0.0f);
}

TEST(ViewRaster, EdgesAreWhereAnotherSurfaceBegins) {
  output::TriangleMesh mesh = test::wall_mesh();
  test::add_wall(mesh, 4, 0.4f, 0, 0, 1.0f);  // a board half way: 52 pixels
  const ViewRaster raster = rasterised(mesh, test::small_camera(), {});
  const Image<std::uint8_t> distance = distance_from_edges_px(raster.inverse_depth_per_m);
  EXPECT_GE(distance.at(80, 60), 20);
  EXPECT_LE(distance.at(80 + 26, 60), 1);
  EXPECT_NEAR(distance.at(80 + 35, 60), 35 - 26, 1);
}

TEST(ViewRaster, APlaneAtASlantHasNoEdges) {
  output::TriangleMesh mesh;
  // Some 72 degrees.
  mesh.positions_m = {{-100, -100, 1}, {100, -100, 1}, {-100, 100, 601}, {100, 100, 601}};
  for (Eigen::Vector3f& p : mesh.positions_m) p.z() = 2.5f + 3 * p.y();
  mesh.normals.assign(4, Eigen::Vector3f(0, 3, -1).normalized());
  mesh.colors.resize(4);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
  const Image<std::uint8_t> distance =
      distance_from_edges_px(rasterised(mesh, test::small_camera(), {}).inverse_depth_per_m);
  EXPECT_EQ(distance.at(80, 40), kFarFromEdge_px);
}

TEST(TextureView, DoesNotSeeWhatIsHidden) {
  output::TriangleMesh mesh = test::wall_mesh();
  test::add_wall(mesh, 4, 0.4f, 0, 0, 1.0f);
  const TextureFrames frames = test::wall_frames({Rigid3()}, {Rigid3()});
  const Result<TextureView> view = load_view(mesh, frames, 0);
  ASSERT_TRUE(view.ok());
  const Eigen::Vector3f towards(0, 0, -1);
  EXPECT_FALSE(seen_at(*view, frames.camera, {0, 0, 2}, towards, 1)) << "behind the board";
  EXPECT_TRUE(seen_at(*view, frames.camera, {0, 0, 1}, towards, 1)) << "the board";
  EXPECT_TRUE(seen_at(*view, frames.camera, {0.7f, 0, 2}, towards, 1)) << "the wall beside it";
  EXPECT_FALSE(seen_at(*view, frames.camera, {0.41f, 0, 2}, towards, 1))
      << "the wall where the board's edge is";
  EXPECT_FALSE(seen_at(*view, frames.camera, {0, 0, 1}, -towards, 1)) << "from behind";
  EXPECT_FALSE(seen_at(*view, frames.camera, {0, 0, -1}, towards, 1)) << "behind the camera";
}

}  // namespace
}  // namespace hermite::texture
