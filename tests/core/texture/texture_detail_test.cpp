#include "core/texture/texture_detail.h"

#include <gtest/gtest.h>

#include "core/texture/atlas.h"
#include "tests/core/texture/texture_scene.h"

namespace hermite::texture {
namespace {

TEST(TextureDetail, IsThatOfTheNearestViewAndNoneWhereNoneSees) {
  Rigid3 near;
  near.translation.z() = 1.5;  // 0.5 m from the wall: sees 62 x 46 cm
  const std::vector<Rigid3> poses{test::grid_of_poses(1, 1)[0], near};
  const TextureFrames frames = test::wall_frames(poses, poses);
  const output::TriangleMesh wall = test::wall_mesh();
  const std::vector<TextureView> views{or_throw(load_view(wall, frames, 0)),
                                       or_throw(load_view(wall, frames, 1))};
  TextureOptions options;
  options.thread_count = 2;
  const std::vector<float> finest_m = finest_pixels_m(wall, frames.camera, views, options);
  ASSERT_EQ(finest_m.size(), wall.positions_m.size());
  for (std::size_t i = 0; i < finest_m.size(); ++i) {
    const Eigen::Vector3f& at = wall.positions_m[i];
    if (at.head<2>().norm() < 0.01f) {
      EXPECT_NEAR(finest_m[i], 0.5f / 130, 1e-6f);
    }
    if (std::abs(at.x()) > 0.35f && at.head<2>().norm() < 0.5f) {
      EXPECT_NEAR(finest_m[i], 1.2f / 130, 0.0015f) << at.transpose();
    }
    if (at.head<2>().cwiseAbs().minCoeff() > 0.9f) {
      EXPECT_EQ(finest_m[i], kNeverSeen_m) << at.transpose();
    }
  }
}

TEST(TextureDetail, MakesTexelsFinerWithinLimits) {
  const output::TriangleMesh wall = test::wall_mesh();
  TextureOptions options;
  options.texel_m = 0.01;
  const auto texel_m = [&](float finest_m) {
    const std::vector<float> finest(wall.positions_m.size(), finest_m);
    return or_throw(atlas_of(wall, finest, options)).charts[0].texel_m;
  };
  EXPECT_NEAR(texel_m(kNeverSeen_m), 0.01f, 1e-5f);
  EXPECT_NEAR(texel_m(0.03f), 0.01f, 1e-5f) << "no larger than asked for";
  EXPECT_NEAR(texel_m(0.01f), kTexelsOfPixel * 0.01f, 1e-5f);
  EXPECT_NEAR(texel_m(0.0001f), kSmallestShare * 0.01f, 1e-5f);
}

}  // namespace
}  // namespace hermite::texture
