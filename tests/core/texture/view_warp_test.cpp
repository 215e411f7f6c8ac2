#include "core/texture/view_warp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/texture/texture_scene.h"

namespace hermite::texture {
namespace {

constexpr std::size_t kBent = 4;  // the view in the middle of nine

// Where a lens that nobody knows of puts what belongs at a pixel.
Eigen::Vector2f planted_px(double u, double v) {
  return {static_cast<float>(2.5 * std::sin(0.015 * v)),
          static_cast<float>(1.5 * std::cos(0.012 * u))};
}

TextureFrames frames_with_a_bent_one(const std::vector<Rigid3>& poses) {
  TextureFrames frames = test::wall_frames(poses, poses);
  const auto straight = frames.read;
  frames.read = [straight, poses](std::size_t i) -> Result<ColorImage> {
    if (i != kBent) return straight(i);
    ColorImage image(160, 120);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        Eigen::Vector2d from(x, y);  // the pixel that was moved here
        for (int round = 0; round < 3; ++round)
          from = Eigen::Vector2d(x, y) - planted_px(from.x(), from.y()).cast<double>();
        const Eigen::Vector3d at =
            poses[i].translation + 1.2 * test::small_camera().unproject(from.x(), from.y(), 1);
        image.at(x, y) = test::byte_color(test::wall_color(at.x(), at.y()));
      }
    return image;
  };
  return frames;
}

TextureOptions with_threads(int count) {
  TextureOptions options;
  options.thread_count = count;
  return options;
}

TEST(ViewWarp, FindsWhatAViewIsBentByAndLeavesTheOthers) {
  const std::vector<Rigid3> poses = test::grid_of_poses(3, 3);
  const output::TriangleMesh wall = test::wall_mesh();
  const TextureFrames frames = frames_with_a_bent_one(poses);
  std::vector<TextureView> views, again;
  for (std::size_t i = 0; i < poses.size(); ++i)
    views.push_back(or_throw(load_view(wall, frames, i)));
  again = views;
  warp_views(wall, frames, with_threads(2), views);
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const float u : {30.0f, 80.0f, 130.0f})
      for (const float v : {30.0f, 60.0f, 90.0f}) {
        const Eigen::Vector2f right =
            i == kBent ? planted_px(static_cast<double>(u), static_cast<double>(v))
                       : Eigen::Vector2f(0, 0);
        EXPECT_LT((views[i].warp.at(u, v) - right).norm(), i == kBent ? 0.8f : 0.5f)
            << "view " << i << " at " << u << ", " << v;
      }
  warp_views(wall, frames, with_threads(5), again);
  for (std::size_t i = 0; i < views.size(); ++i)
    EXPECT_TRUE(views[i].warp.nodes_px == again[i].warp.nodes_px) << "another number of threads";
}

TEST(ViewWarp, StopsWhenItIsTold) {
  const std::vector<Rigid3> poses = test::grid_of_poses(3, 3);
  const output::TriangleMesh wall = test::wall_mesh();
  const TextureFrames frames = frames_with_a_bent_one(poses);
  std::vector<TextureView> views;
  for (std::size_t i = 0; i < poses.size(); ++i)
    views.push_back(or_throw(load_view(wall, frames, i)));
  TextureOptions options = with_threads(2);
  options.is_stopped = [] { return true; };
  warp_views(wall, frames, options, views);
  for (const Eigen::Vector2f& node : views[kBent].warp.nodes_px) EXPECT_EQ(node.norm(), 0);
}

TEST(ViewWarp, OfAViewWithNothingToSeeIsNone) {
  const std::vector<Rigid3> poses = test::grid_of_poses(2, 1);
  TextureFrames frames = test::wall_frames(poses, poses);
  frames.read = [](std::size_t) -> Result<ColorImage> { return ColorImage(160, 120); };
  const output::TriangleMesh wall = test::wall_mesh();
  std::vector<TextureView> views{or_throw(load_view(wall, frames, 0)),
                                 or_throw(load_view(wall, frames, 1))};
  warp_views(wall, frames, with_threads(2), views);
  for (const TextureView& view : views)
    for (const Eigen::Vector2f& node : view.warp.nodes_px) EXPECT_EQ(node.norm(), 0);
}

}  // namespace
}  // namespace hermite::texture
