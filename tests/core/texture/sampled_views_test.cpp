#include "core/texture/sampled_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "tests/core/texture/texture_scene.h"

namespace hermite::texture {
namespace {

// View i says 10 (i + 1) of every point.
struct ThreeViews {
  explicit ThreeViews(std::size_t guest_count) {
    const std::vector<Rigid3> poses = test::grid_of_poses(3, 1);
    const TextureFrames frames = test::wall_frames(poses, poses);
    const output::TriangleMesh wall = test::wall_mesh();
    for (std::size_t i = 0; i < poses.size(); ++i)
      views.push_back(or_throw(load_view(wall, frames, i)));
    options.thread_count = 2;
    seen.emplace(wall, camera, options, AdjustedViews{views, guest_count},
                 SampleDensity{0.05, 10'000, 2});
    seen->find_points([](std::size_t view, std::uint32_t) {
      return Look{10 * static_cast<float>(view + 1), 1};
    });
  }
  // What the others say of a point that all three see.
  std::optional<float> said(std::size_t view) const {
    for (std::size_t k = 0; k < seen->sights[view].size(); ++k)
      if (std::all_of(seen->sights.begin(), seen->sights.end(),
                      [&](const std::vector<std::uint32_t>& sights) {
                        return std::binary_search(sights.begin(), sights.end(),
                                                  seen->sights[view][k]);
                      }))
        return seen->others_say(view, k);
    ADD_FAILURE() << "no point is seen by all";
    return std::nullopt;
  }
  int moving_count() const {
    std::atomic<int> count = 0;
    seen->for_each_moving([&](std::size_t) { ++count; });
    return count;
  }

  const Camera camera = test::small_camera();
  TextureOptions options;
  std::vector<TextureView> views;
  std::optional<SampledViews> seen;
};

TEST(SampledViews, AViewIsHeldAgainstTheMeanOfTheOthers) {
  const ThreeViews all(0);
  EXPECT_EQ(all.said(0), 25);
  EXPECT_EQ(all.said(1), 20);
  EXPECT_EQ(all.said(2), 15);
  EXPECT_EQ(all.moving_count(), 3);
}

TEST(SampledViews, AGuestHasNoSayAndMovesAlone) {
  const ThreeViews guest(1);
  EXPECT_EQ(guest.said(0), 20);
  EXPECT_EQ(guest.said(2), 15);
  EXPECT_EQ(guest.moving_count(), 1);
}

}  // namespace
}  // namespace hermite::texture
