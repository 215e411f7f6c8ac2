#include "core/texture/texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/texture/texture_quality.h"
#include "core/texture/view_alignment.h"
#include "core/texture/view_exposure.h"
#include "core/texture/view_selection.h"
#include "tests/core/texture/texture_scene.h"

namespace hermite::texture {
namespace {

TextureOptions wall_options() {
  TextureOptions options;
  options.texel_m = 0.005;
  options.page_px = 1024;
  options.thread_count = 2;
  return options;
}

std::vector<TextureView> views_of(const output::TriangleMesh& mesh, const TextureFrames& frames) {
  std::vector<TextureView> views;
  for (std::size_t i = 0; i < frames.world_from_camera.size(); ++i)
    views.push_back(or_throw(load_view(mesh, frames, i)));
  return views;
}

// Of what the camera sees of the wall from a place between the others.
double wall_psnr_db(const output::TriangleMesh& mesh) {
  const Rigid3 pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ())),
                    {0.04, -0.02, 0.9}};
  return psnr_db(drawn(mesh, test::small_camera(), pose, MeshColor::kTexture),
                 test::wall_image(test::small_camera(), pose));
}

TEST(Texture, OfACheckerOnAWallIsTheChecker) {
  const std::vector<Rigid3> poses = test::grid_of_poses(5, 4);
  TextureStatistics statistics;
  const Result<output::TriangleMesh> mesh =
      textured(test::wall_mesh(), test::wall_frames(poses, poses), wall_options(), {}, &statistics);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(statistics.views, 20u);
  EXPECT_EQ(statistics.charts, 1u) << "a wall is one piece";
  EXPECT_GT(wall_psnr_db(*mesh), 35);
  EXPECT_EQ(mesh->triangles.size(), test::wall_mesh().triangles.size());
}

TEST(Texture, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Rigid3> poses = test::grid_of_poses(3, 2);
  const TextureFrames frames = test::wall_frames(poses, poses, {1, 1.1, 0.9, 1.2, 1, 0.8});
  TextureOptions options = wall_options();
  const Result<output::TriangleMesh> first = textured(test::wall_mesh(), frames, options);
  ASSERT_TRUE(first.ok()) << first.error().message;
  for (const int thread_count : {1, 5}) {
    options.thread_count = thread_count;
    const Result<output::TriangleMesh> again = textured(test::wall_mesh(), frames, options);
    ASSERT_TRUE(again.ok());
    ASSERT_EQ(again->pages.size(), first->pages.size());
    EXPECT_TRUE(again->pages[0].image == first->pages[0].image) << thread_count << " threads";
    EXPECT_EQ(again->triangles, first->triangles);
    EXPECT_EQ(again->texture_coordinates, first->texture_coordinates);
  }
}

TEST(Texture, WhereNoViewSeesTheSurfaceHasTheColourAround) {
  output::TriangleMesh wall = test::wall_mesh();
  // 1.2 m away: sees 1.5 x 1.1 of 2 x 2 m.
  const std::vector<Rigid3> poses{test::grid_of_poses(1, 1)};
  const Result<output::TriangleMesh> mesh =
      textured(wall, test::wall_frames(poses, poses), wall_options());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  const Rigid3 far{Eigen::Quaterniond::Identity(), {0, 0, -0.5}};
  const MeshRendering rendering = drawn(*mesh, test::small_camera(), far, MeshColor::kTexture);
  for (std::size_t i = 0; i < rendering.is_covered.pixels.size(); ++i)
    if (rendering.is_covered.pixels[i] != 0) {
      EXPECT_GT(rendering.color.pixels[i].g, 50) << "a black hole";
    }
}

TEST(Exposure, PlantedGainsComeBack) {
  const std::vector<Rigid3> poses = test::grid_of_poses(4, 3);
  std::vector<double> gains;
  for (std::size_t i = 0; i < poses.size(); ++i)
    gains.push_back(0.8 + 0.4 * static_cast<double>((i * 5) % 12) / 11);
  const output::TriangleMesh wall = test::wall_mesh();
  std::vector<TextureView> views = views_of(wall, test::wall_frames(poses, poses, gains));
  TextureOptions two_threads;
  two_threads.thread_count = 2;
  int questions = 0;
  TextureOptions stopped;
  stopped.thread_count = 1;
  // Stops after the views, between the rounds of the solver.
  stopped.is_stopped = [&questions] { return ++questions > 20; };
  solve_exposure(wall, test::small_camera(), stopped, views);
  EXPECT_LT(questions, 30) << "it does not go on";
  for (const TextureView& view : views) EXPECT_EQ(view.gain, Eigen::Vector3f::Ones());
  solve_exposure(wall, test::small_camera(), two_threads, views);
  double mean_log = 0;
  for (const double gain : gains) mean_log += std::log(gain) / static_cast<double>(gains.size());
  for (std::size_t i = 0; i < views.size(); ++i)
    EXPECT_NEAR(views[i].gain.y(), gains[i] / std::exp(mean_log), 0.02) << "view " << i;
}

TEST(Alignment, APoseThatIs3mmOffComesBack) {
  const std::vector<Rigid3> true_poses = test::grid_of_poses(4, 3);
  std::vector<Rigid3> poses = true_poses;
  poses[5] =
      poses[5] * Rigid3{Eigen::Quaterniond(Eigen::AngleAxisd(0.002, Eigen::Vector3d::UnitZ())),
                        {0.003, -0.002, 0}};
  const TextureFrames frames = test::wall_frames(true_poses, poses);
  const output::TriangleMesh wall = test::wall_mesh();
  std::vector<TextureView> views = views_of(wall, frames);
  TextureOptions two_threads;
  two_threads.thread_count = 2;
  const Alignment alignment = align_views(wall, frames, two_threads, views);
  EXPECT_LT(alignment.after_rms, alignment.before_rms);
  // A small turn and a small step look alike on a wall: what counts is where the pixels of the
  // image lie on it.
  const auto off_m = [&](const Rigid3& pose, const Rigid3& true_pose) {
    double farthest_m = 0;
    for (const double u : {20.0, 140.0})
      for (const double v : {20.0, 100.0}) {
        const auto on_wall = [&](const Rigid3& world_from_camera) {
          const Eigen::Vector3d ray =
              world_from_camera.rotation * test::small_camera().unproject(u, v, 1);
          const Eigen::Vector3d& from = world_from_camera.translation;
          return Eigen::Vector3d(from +
                                 (static_cast<double>(test::kWall_m) - from.z()) / ray.z() * ray);
        };
        farthest_m = std::max(farthest_m, (on_wall(pose) - on_wall(true_pose)).norm());
      }
    return farthest_m;
  };
  ASSERT_GT(off_m(poses[5], true_poses[5]), 0.003);
  for (std::size_t i = 0; i < views.size(); ++i)
    EXPECT_LT(off_m(views[i].world_from_camera, true_poses[i]), 0.0015)
        << "a sixth of a pixel, view " << i;
}

TEST(Selection, TakesTheSharperOfTwoAlikeAndPassesOverLostFrames) {
  const std::vector<Rigid3> poses = test::grid_of_poses(2, 1);
  TextureFrames frames = test::wall_frames({poses[0], poses[0], poses[0], poses[1]},
                                           {poses[0], poses[0], poses[0], poses[1]});
  frames.world_from_camera[2].reset();
  const auto sharp = frames.read;
  frames.read = [sharp](std::size_t i) -> Result<ColorImage> {
    if (i == 2) return Error{ErrorCode::kIo, "nobody should read this"};
    if (i != 0) return sharp(i);
    ColorImage flat(160, 120);
    return flat;
  };
  EXPECT_EQ(selected_views(test::wall_mesh(), frames, wall_options()),
            (std::vector<std::size_t>{1, 3}));
}

TEST(Selection, SpreadsFewViewsOverTheSurface) {
  const std::vector<Rigid3> poses = test::grid_of_poses(9, 1);
  TextureOptions options = wall_options();
  options.max_views = 3;
  const std::vector<std::size_t> chosen =
      selected_views(test::wall_mesh(), test::wall_frames(poses, poses), options);
  ASSERT_EQ(chosen.size(), 3u);
  EXPECT_LE(chosen.front(), 2u);
  EXPECT_GE(chosen.back(), 6u);
}

TEST(HeldOut, SaysHowNearTheTextureComes) {
  const std::vector<Rigid3> poses = test::grid_of_poses(5, 4);
  const Result<HeldOutQuality> quality =
      held_out_quality(test::wall_mesh(), test::wall_frames(poses, poses), wall_options());
  ASSERT_TRUE(quality.ok()) << quality.error().message;
  EXPECT_EQ(quality->frames.size(), 2u);
  EXPECT_GT(quality->texture_db, 33);
  EXPECT_LT(quality->vertices_db, 22) << "grey";
  const std::vector<Rigid3> few = test::grid_of_poses(2, 1);
  EXPECT_EQ(
      held_out_quality(test::wall_mesh(), test::wall_frames(few, few), wall_options()).error().code,
      ErrorCode::kNotFound);
}

TEST(Texture, SaysWhatIsWrongWithWhatItIsGiven) {
  const std::vector<Rigid3> poses = test::grid_of_poses(2, 1);
  const TextureFrames frames = test::wall_frames(poses, poses);
  const TextureOptions options = wall_options();
  EXPECT_EQ(textured({}, frames, options).error().code, ErrorCode::kInvalidArgument)
      << "no triangle";
  output::TriangleMesh mesh = test::wall_mesh();
  mesh.positions_m[7].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(textured(mesh, frames, options).error().message.find("7"), std::string::npos)
      << "the vertex";
  mesh = test::wall_mesh();
  mesh.triangles[3][1] = 100'000;
  EXPECT_EQ(textured(mesh, frames, options).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(textured(test::wall_mesh(), test::wall_frames({}, {}), options).error().code,
            ErrorCode::kNotFound)
      << "no views";
  Rigid3 away;
  away.translation.z() = 50;
  EXPECT_EQ(textured(test::wall_mesh(), test::wall_frames({away}, {away}), options).error().code,
            ErrorCode::kNotFound)
      << "sees nothing";
  TextureOptions wrong = options;
  wrong.texel_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(textured(test::wall_mesh(), frames, wrong).error().message.find("texel_m"),
            std::string::npos);
  TextureFrames bent = frames;
  bent.camera.distortion.k1 = 0.1;
  EXPECT_EQ(textured(test::wall_mesh(), bent, options).error().code, ErrorCode::kInvalidArgument);
  TextureFrames unreadable = frames;
  unreadable.read = [](std::size_t) -> Result<ColorImage> { return Error{ErrorCode::kIo, "gone"}; };
  EXPECT_EQ(textured(test::wall_mesh(), unreadable, options).error().code, ErrorCode::kNotFound);
}

TEST(Texture, StopsWhenItIsTold) {
  const std::vector<Rigid3> poses = test::grid_of_poses(2, 1);
  for (const double share : {0.0, 0.3, 0.9}) {
    const auto stops = [share](double done) { return done < share; };
    EXPECT_EQ(textured(test::wall_mesh(), test::wall_frames(poses, poses), wall_options(), stops)
                  .error()
                  .code,
              ErrorCode::kBusy);
  }
}

}  // namespace
}  // namespace hermite::texture
