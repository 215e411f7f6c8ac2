// Several submaps in one map: whose surfels new ones become, where they lie when a submap moves,
// and what a view leaves out.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "core/map/fuse.h"
#include "tests/support/gpu_test.h"
#include "tests/support/index_slots.h"
#include "tests/support/map_bench.h"
#include "tests/support/packing.h"

namespace hermite::map::submaps_test {
namespace {

using test::FuseInput;
using test::MapBench;

const Camera kCamera{48, 32, 40, 40, 23.5, 15.5, 1000};

MapOptions keeping() {
  MapOptions options;
  options.stable_confidence = 0.1;
  options.max_unstable_age_frames = 1'000'000;
  return options;
}

const Rigid3 kElsewhere = exp_se3((Vector6d() << 0.4, -0.2, 0.3, 0.2, -0.4, 0.1).finished());

class SubmapsTest : public test::GpuTest {
 protected:
  SubmapsTest() : bench(device(), kCamera, keeping()) {}

  // A wall at `depth_m`, into submap `submap`.
  void fuse_wall(float depth_m, std::uint32_t number, std::uint32_t submap,
                 const Rigid3& world_from_camera = {}) {
    if (submap != bench.submap) bench.store.begin_block();
    bench.submap = submap;
    bench.fuse(test::frontal_frame(kCamera, depth_m, 1), number, world_from_camera);
    bench.clean(number, world_from_camera);
    test::expect_consistent(bench.store);
  }

  std::vector<Surfel> alive() const {
    std::vector<Surfel> surfels;
    for (const Surfel& s : bench.store.download())
      if (s.confidence > 0) surfels.push_back(s);
    return surfels;
  }

  std::size_t shown_pixels(const SubmapSet& seen, const Rigid3& world_from_camera = {}) {
    bench.look(seen, world_from_camera);
    const std::vector<shared::uint> slots = test::slots_of(bench.index);
    return slots.size() -
           static_cast<std::size_t>(std::count(slots.begin(), slots.end(), kNoSurfel));
  }

  MapBench bench;
};

TEST_F(SubmapsTest, NewSurfelsAreOfTheCurrentSubmapAndInItsFrame) {
  bench.store.set_submaps(std::vector<Rigid3>{{}, kElsewhere});
  fuse_wall(1.5f, 1, 1);
  const std::vector<Surfel> surfels = alive();
  ASSERT_EQ(surfels.size(), 48u * 32);
  for (const Surfel& s : surfels) {
    ASSERT_EQ(s.submap, 1u);
    const Eigen::Vector3d in_world = kElsewhere * s.position_in_submap_m.cast<double>();
    ASSERT_NEAR(in_world.z(), 1.5, 1e-5);
    ASSERT_NEAR((kElsewhere.rotation * s.normal_in_submap.cast<double>()).z(), 1,
                test::kNormalLoss);
  }
}

TEST_F(SubmapsTest, BlocksHoldSurfelsOfOneSubmap) {
  bench.store.set_submaps(std::vector<Rigid3>{{}, kElsewhere, Rigid3{}});
  for (std::uint32_t number = 1; number <= 60; ++number) {
    // Ever nearer walls: those behind are seen through and removed, and their slots used again.
    fuse_wall(3.0f - 0.04f * static_cast<float>(number), number, number / 7 % 3);
  }
  std::vector<std::set<std::uint32_t>> submaps_of_block(bench.store.slot_count() / kSlotsPerBlock +
                                                        1);
  const std::vector<Surfel> surfels = bench.store.download();
  std::set<std::uint32_t> all;
  for (std::size_t slot = 0; slot < surfels.size(); ++slot)
    if (surfels[slot].confidence > 0) {
      submaps_of_block[slot / kSlotsPerBlock].insert(surfels[slot].submap);
      all.insert(surfels[slot].submap);
    }
  EXPECT_EQ(all.size(), 3u);
  for (const std::set<std::uint32_t>& submaps : submaps_of_block) EXPECT_LE(submaps.size(), 1u);
}

TEST_F(SubmapsTest, AMovedSubmapTakesItsSurfelsAlong) {
  bench.store.set_submaps(std::vector<Rigid3>{{}, kElsewhere});
  fuse_wall(1.5f, 1, 1);
  EXPECT_EQ(shown_pixels({true, true}), 48u * 32);
  // The camera comes along: it sees what it saw.
  const Rigid3 correction = exp_se3((Vector6d() << 5, 1, -3, 1, 2, 0.5).finished());
  bench.store.set_submaps(std::vector<Rigid3>{{}, correction * kElsewhere});
  EXPECT_EQ(shown_pixels({true, true}), 0u);
  EXPECT_GT(shown_pixels({true, true}, correction), 48u * 32 * 9 / 10)
      << "rounding may move some to the next pixel";
}

TEST_F(SubmapsTest, SubmapsOutsideTheSetAreNotSeen) {
  bench.store.set_submaps(std::vector<Rigid3>{{}, kElsewhere});
  fuse_wall(2.0f, 1, 0);
  fuse_wall(1.0f, 2, 1);
  ASSERT_EQ(alive().size(), 2u * 48 * 32);
  const auto nearest_m = [&](const SubmapSet& seen) {
    EXPECT_EQ(shown_pixels(seen), seen[0] || seen[1] ? 48u * 32 : 0u);
    return std::bit_cast<float>(
        bench.index.nearest().download()[kCamera.width * 16 + 20].depth_bits);
  };
  EXPECT_NEAR(nearest_m({true, true}), 1.0f, 1e-5f);
  EXPECT_NEAR(nearest_m({false, true}), 1.0f, 1e-5f);
  EXPECT_NEAR(nearest_m({true, false}), 2.0f, 1e-5f);
  shown_pixels({false, false});
}

TEST_F(SubmapsTest, WhatIsNotSeenIsNeitherMergedNorRemoved) {
  bench.store.set_submaps(std::vector<Rigid3>{{}, kElsewhere});
  fuse_wall(1.5f, 1, 0);
  const std::vector<Surfel> before = bench.store.download();
  bench.seen = SubmapSet{false, true};
  for (std::uint32_t number = 2; number < 40; ++number) fuse_wall(1.502f, number, 1);
  const std::vector<Surfel> after = bench.store.download();
  for (std::size_t slot = 0; slot < 48u * 32; ++slot) {
    ASSERT_EQ(after[slot].position_in_submap_m, before[slot].position_in_submap_m);
    ASSERT_EQ(after[slot].confidence, before[slot].confidence);
  }
  // Seen again, one layer of the two goes: they are closer than the depth at which surfels are
  // redundant.
  bench.seen = SubmapSet{true, true};
  for (std::uint32_t number = 40; number < 80; ++number) fuse_wall(1.501f, number, 1);
  EXPECT_LT(alive().size(), 48u * 32 * 11 / 10);
}

TEST_F(SubmapsTest, ThereIsRoomForManySubmaps) {
  std::vector<Rigid3> poses(5000);
  poses.back() = kElsewhere;
  bench.store.set_submaps(poses);
  fuse_wall(1.5f, 1, 4999);
  EXPECT_EQ(alive().front().submap, 4999u);
  EXPECT_EQ(shown_pixels(SubmapSet(5000, true)), 48u * 32);
}

}  // namespace
}  // namespace hermite::map::submaps_test
