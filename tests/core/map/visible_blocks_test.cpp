#include "core/map/visible_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "core/frame/shared_transform.h"
#include "tests/support/gpu_test.h"
#include "tests/support/surface_image.h"

namespace hermite::map::visible_blocks_test {
namespace {

using Eigen::Vector3d;

const Camera kCamera{64, 48, 60, 60, 31.5, 23.5, 1000};

// A block of surfels in a cube of `size_m` around a point.
void add_block(std::vector<Surfel>& surfels, const Vector3d& centre_m, double size_m,
               std::uint32_t submap = 0) {
  static std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (std::uint32_t i = 0; i < kSlotsPerBlock; ++i) {
    Surfel s;
    s.position_in_submap_m =
        (centre_m + size_m * Vector3d(unit(random), unit(random), unit(random))).cast<float>();
    s.normal_in_submap = Eigen::Vector3f::UnitZ();
    s.radius_m = 0.02f;
    s.confidence = 5;
    s.submap = submap;
    surfels.push_back(s);
  }
}

class VisibleBlocksTest : public test::GpuTest {
 protected:
  VisibleBlocksTest() : store(device()), visible(device(), MapOptions{}) {}

  // Those listed as in view; `in_turn` gets the others.
  std::vector<std::uint32_t> in_view(std::uint32_t frame_number,
                                     std::vector<std::uint32_t>* in_turn = nullptr) {
    gpu::Commands commands(device());
    visible.list(commands, store, frame::intrinsics_of(kCamera), frame_number);
    commands.submit_and_wait();
    const std::vector<shared::uint> list = store.visible_blocks.download();
    shared::VisibleHead head;
    std::memcpy(&head, list.data(), sizeof(head));
    for (const shared::uint* groups : {head.groups, head.turn_groups})
      EXPECT_TRUE(groups[1] == 1 && groups[2] == 1);
    EXPECT_LE(head.turn_groups[0], head.groups[0]) << "those in turn are some of all";
    std::vector<std::uint32_t> blocks;
    for (std::size_t i = HERMITE_VISIBLE_HEAD_WORDS;
         i < HERMITE_VISIBLE_HEAD_WORDS + head.groups[0]; ++i) {
      const std::uint32_t block = list[i] & 0xffffu;
      if ((list[i] & 0x80000000u) == 0)
        blocks.push_back(block);
      else if (in_turn != nullptr)
        in_turn->push_back(block);
    }
    std::sort(blocks.begin(), blocks.end());
    return blocks;
  }

  SurfelStore store;
  VisibleBlocks visible;
};

using Blocks = std::vector<std::uint32_t>;

TEST_F(VisibleBlocksTest, OfAnEmptyMapAreNone) { EXPECT_EQ(in_view(1), Blocks{}); }

TEST_F(VisibleBlocksTest, AreThoseThatReachIntoTheView) {
  std::vector<Surfel> surfels;
  add_block(surfels, {0, 0, 2}, 0.5);       // 0: in the middle
  add_block(surfels, {0, 0, -2}, 0.5);      // 1: behind
  add_block(surfels, {2.5, 0, 2}, 0.5);     // 2: to the right of a view 2.1 m wide
  add_block(surfels, {1.2, 0, 2}, 0.5);     // 3: across its border
  add_block(surfels, {0, -2.5, 2}, 0.5);    // 4: above
  add_block(surfels, {0, 0, 25}, 0.5);      // 5: too far
  add_block(surfels, {0, 0, 0}, 10);        // 6: all around the camera
  add_block(surfels, {-2.5, 0, 4.5}, 0.5);  // 7: farther away the view is wider
  test::upload(surfels, store);
  store.set_camera(Rigid3{});
  EXPECT_EQ(in_view(1), (Blocks{0, 3, 6, 7}));
  // Turned to the right by 80 degrees and a metre back.
  store.set_camera(
      {Eigen::Quaterniond(Eigen::AngleAxisd(80 * M_PI / 180, Vector3d::UnitY())), {-0.7, 0, -0.7}});
  EXPECT_EQ(in_view(1), (Blocks{2, 6}));
}

TEST_F(VisibleBlocksTest, OfOtherSubmapsAreSeenWithTheirPose) {
  std::vector<Surfel> surfels;
  add_block(surfels, {0, 0, 2}, 0.5, 0);
  add_block(surfels, {0, 0, 2}, 0.5, 1);
  add_block(surfels, {0, 0, -2}, 0.5, 0);
  surfels.back().submap = 1;  // of two submaps: no box can be put around them
  test::upload(surfels, store);
  store.camera_from_submap = gpu::Buffer<shared::Transform>(device(), 2, "test");
  store.camera_from_submap.upload(std::vector<shared::Transform>{
      frame::to_shared(Rigid3{}), frame::to_shared({Eigen::Quaterniond::Identity(), {0, 0, -9}})});
  EXPECT_EQ(in_view(1), (Blocks{0, 2}));
}

// Age counts out of view too, so each is looked at once in a while, another one in every frame.
TEST_F(VisibleBlocksTest, EveryBlockHasItsTurn) {
  std::vector<Surfel> surfels;
  for (int i = 0; i < 200; ++i) add_block(surfels, {0, 0, -3}, 0.5);
  test::upload(surfels, store);
  store.set_camera(Rigid3{});
  std::vector<int> turns(200);
  for (std::uint32_t frame = 1; frame <= 128; ++frame) {
    Blocks in_turn;
    EXPECT_EQ(in_view(frame, &in_turn), Blocks{});
    EXPECT_LE(in_turn.size(), 4u);
    for (const std::uint32_t block : in_turn) ++turns[block];
  }
  EXPECT_EQ(turns, std::vector<int>(200, 2)) << "once in 64 frames";
}

}  // namespace
}  // namespace hermite::map::visible_blocks_test
