// The other half of core/map/fuse.h: which surfels are removed, and what becomes of their slots.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/map/fuse.h"
#include "tests/reference/frame_twin.h"
#include "tests/support/gpu_test.h"
#include "tests/support/map_bench.h"
#include "tests/support/packing.h"

namespace hermite::map::clean_test {
namespace {

using Eigen::Vector3d;
using test::MapBench;

const Camera kCamera{64, 64, 80, 80, 31, 31, 1000};
constexpr std::uint32_t kNow = 300;

MapOptions cleaning() {
  MapOptions options;
  options.clean_interval_frames = 1;
  options.stable_confidence = 3;
  options.redundancy_depth_m = 0.01;
  options.max_unstable_age_frames = 200;
  return options;
}

Surfel surfel_seen_at(double u, double v, double depth_m, float confidence,
                      std::uint32_t created_frame) {
  Surfel s;
  s.position_in_submap_m = kCamera.unproject(u, v, depth_m).cast<float>();
  s.normal_in_submap = Eigen::Vector3f::UnitZ();
  s.radius_m =
      static_cast<float>(test::support_radius_m(frame::intrinsics_of(kCamera), 4, depth_m, 1));
  s.confidence = confidence;
  s.created_frame = s.observed_frame = created_frame;
  return s;
}

// What one surfel finds behind it: `count` stable surfels in the 3x3 pixels around it.
struct Scene {
  double gap_m = 0.005;
  int count = 9;
  int elsewhere_count = 0;  // and far behind, seen long ago
  float background_confidence = 10;
  std::uint32_t background_created = 5, background_observed = 290;
  Surfel victim = surfel_seen_at(20, 20, 1, 1, 250);
};

std::vector<Surfel> surfels_of(const Scene& scene) {
  std::vector<Surfel> surfels{scene.victim};
  for (int i = 0; i < scene.count; ++i) {
    Surfel s = surfel_seen_at(19 + i % 3, 19 + i / 3, 1 + scene.gap_m, scene.background_confidence,
                              scene.background_created);
    s.observed_frame = scene.background_observed;
    surfels.push_back(s);
  }
  for (int i = scene.count; i < scene.count + scene.elsewhere_count; ++i)
    surfels.push_back(surfel_seen_at(19 + i % 3, 19 + i / 3, 1.3, 10, 5));
  return surfels;
}

class CleanTest : public test::GpuTest {
 protected:
  CleanTest() : bench(device(), kCamera, cleaning()) {}

  // Whether the surfel in slot 0 is still there; nobody else may go.
  bool survives(const Scene& scene) {
    test::upload(surfels_of(scene), bench.store);
    bench.clean(kNow);
    test::expect_consistent(bench.store);
    const std::vector<Surfel> after = bench.store.download();
    for (std::size_t slot = 1; slot < after.size(); ++slot)
      EXPECT_GT(after[slot].confidence, 0) << "slot " << slot;
    const bool survived = after[0].confidence > 0;
    EXPECT_TRUE(survived || after[0].observed_frame == kNow) << "it says when it went";
    return survived;
  }

  MapBench bench;
};

TEST_F(CleanTest, SurfelsJustInFrontOfOlderOnesAreRedundant) {
  EXPECT_FALSE(survives({}));
  EXPECT_FALSE(survives({.count = 3}));
  EXPECT_TRUE(survives({.count = 2})) << "too few to say";
  EXPECT_FALSE(survives({.count = 5, .elsewhere_count = 4}));
  EXPECT_TRUE(survives({.count = 4, .elsewhere_count = 4})) << "not most of the neighbours";
}

TEST_F(CleanTest, RedundantIsOnlyWhatIsNewerAndCloseInFront) {
  EXPECT_TRUE(survives({.background_created = 250})) << "as old as itself";
  EXPECT_TRUE(survives({.background_created = 251})) << "older than what is behind";
  EXPECT_FALSE(survives({.background_created = 249}));
  EXPECT_TRUE(survives({.background_confidence = 2.9f})) << "not stable";
  EXPECT_TRUE(survives({.gap_m = -0.005})) << "behind it";
  EXPECT_FALSE(survives({.gap_m = 0.0099}));
  EXPECT_TRUE(survives({.gap_m = 0.0101})) << "another surface, not seen now";
}

TEST_F(CleanTest, RedundantIsOnlyWhatIsCloseSidewaysToo) {
  Scene scene;
  // 12.5 mm a pixel at 1 m: the corners are 18 mm away, the sides 13 mm. Within 1.4 radii is what
  // counts.
  scene.victim.radius_m = 0.012f;  // 16.8 mm: the middle and four sides
  EXPECT_FALSE(survives(scene));
  scene.victim.radius_m = 0.008f;  // 11.2 mm: the middle
  EXPECT_TRUE(survives(scene));
}

TEST_F(CleanTest, HiddenBehindAnotherSubmapIsRedundantToo) {
  const auto survives_behind = [this](double gap_m, std::uint32_t submap, std::uint32_t created,
                                      float radius_scale) {
    std::vector<Surfel> surfels{surfel_seen_at(20, 20, 1, 10, 250),
                                surfel_seen_at(20, 20, 1 - gap_m, 10, created)};
    surfels[0].submap = submap;
    surfels[1].radius_m *= radius_scale;
    bench.store.set_submaps(std::vector<Rigid3>(2));
    test::upload(surfels, bench.store);
    bench.clean(kNow);
    EXPECT_GT(bench.store.download()[1].confidence, 0);
    return bench.store.download()[0].confidence > 0;
  };
  EXPECT_FALSE(survives_behind(0.005, 1, 5, 1));
  EXPECT_FALSE(survives_behind(0.0099, 1, 249, 1.4f));
  EXPECT_TRUE(survives_behind(0.0101, 1, 5, 1)) << "another surface";
  EXPECT_TRUE(survives_behind(-0.005, 1, 5, 1)) << "it hides the other one";
  EXPECT_TRUE(survives_behind(0.005, 0, 5, 1))
      << "of the same submap: detail seen from farther away";
  EXPECT_TRUE(survives_behind(0.005, 1, 250, 1)) << "not older";
  EXPECT_TRUE(survives_behind(0.005, 1, 5, 1.6f)) << "coarser: this one shows more";
}

TEST_F(CleanTest, SurfelsInFreeSpaceAreRemoved) {
  EXPECT_FALSE(survives({.gap_m = 0.2, .background_observed = kNow}));
  EXPECT_FALSE(survives({.gap_m = 0.2, .count = 3, .background_observed = kNow}));
  EXPECT_TRUE(survives({.gap_m = 0.2, .count = 2, .background_observed = kNow}))
      << "the edge of something";
  EXPECT_TRUE(survives({.gap_m = 0.2, .background_observed = kNow - 1}))
      << "nobody looks through it now";
  EXPECT_TRUE(survives({.gap_m = 0.2, .background_confidence = 2.9f, .background_observed = kNow}))
      << "not stable";
  EXPECT_TRUE(survives({.gap_m = -0.2, .background_observed = kNow})) << "behind";
  EXPECT_FALSE(survives({.gap_m = 0.0101, .background_created = 290, .background_observed = kNow}));
}

TEST_F(CleanTest, StableSurfelsAreNoExceptionInFreeSpace) {
  Scene scene{.gap_m = 0.2, .background_observed = kNow};
  scene.victim = surfel_seen_at(20, 20, 1, 50, 2);
  EXPECT_TRUE(survives(
      {.gap_m = 0.2, .background_observed = kNow, .victim = surfel_seen_at(40, 40, 1, 50, 2)}))
      << "elsewhere";
  // It hides one of the nine in the index map; eight are left.
  EXPECT_FALSE(survives(scene));
}

TEST_F(CleanTest, SlantedSurfelsAreNotRemovedFromFreeSpace) {
  Scene scene{.gap_m = 0.2, .background_observed = kNow};
  scene.victim = surfel_seen_at(20, 20, 1, 50, 250);
  scene.victim.normal_in_submap = Eigen::Vector3f(0.6f, 0, 0.8f);
  EXPECT_TRUE(survives(scene));
}

TEST_F(CleanTest, UnstableSurfelsThatAreLookedThroughAreRemoved) {
  const auto survives_before = [this](float measured_m, float confidence, std::uint32_t observed,
                                      float own_m = -1, float beside_m = -1) {
    test::FuseInput frame = test::frontal_frame(kCamera, measured_m, 1);
    if (own_m >= 0) frame.raw_depth_m[frame.surface.index(20, 20)] = own_m;
    if (beside_m >= 0) frame.raw_depth_m[frame.surface.index(21, 19)] = beside_m;
    bench.see(frame);
    Scene scene{.count = 0};
    scene.victim = surfel_seen_at(20, 20, 1, confidence, 250);
    scene.victim.normal_in_submap = Eigen::Vector3f(0.8f, 0, 0.6f);
    scene.victim.observed_frame = observed;
    return survives(scene);
  };
  EXPECT_FALSE(survives_before(1.2f, 2.9f, kNow - 10));
  EXPECT_TRUE(survives_before(1.2f, 2.9f, kNow - 9)) << "seen just now";
  EXPECT_TRUE(survives_before(1.2f, 3, kNow - 10)) << "stable";
  EXPECT_FALSE(survives_before(1.051f, 2.9f, kNow - 10));
  EXPECT_TRUE(survives_before(1.049f, 2.9f, kNow - 10)) << "perhaps the same surface";
  EXPECT_TRUE(survives_before(0.8f, 2.9f, kNow - 10)) << "hidden";
  EXPECT_TRUE(survives_before(1.2f, 2.9f, kNow - 10, 0)) << "not measured";
  EXPECT_FALSE(survives_before(1.2f, 2.9f, kNow - 10, 1.2f, 0));
  EXPECT_TRUE(survives_before(1.2f, 2.9f, kNow - 10, 1.2f, 1)) << "the edge of something";
}

// Something slanted stands in the view for two frames and goes; a wall is behind it.
TEST(CleanOptions, WhatStoodInTheViewForAMomentIsGoneWithinASecond) {
  gpu::Device device("");
  const MapOptions options;  // as a scan has them
  MapBench bench(device, kCamera, options);
  const auto is_left = [](const Surfel& s) {
    return s.confidence > 0 && s.position_in_submap_m.z() < 1.2f;
  };
  const auto left_count = [&] {
    const std::vector<Surfel> surfels = bench.store.download();
    return std::count_if(surfels.begin(), surfels.end(), is_left);
  };
  const test::FuseInput wall = test::frontal_frame(kCamera, 1.5f, 0.9f);
  test::FuseInput disturbed = wall;
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) {
      const std::size_t i = disturbed.surface.index(x, y);
      disturbed.surface.depth_m[i] = disturbed.raw_depth_m[i] = 1;
      disturbed.surface.normals[i] =
          test::unpack_normal(test::pack_normal(Vector3d(0.7, 0, 1).normalized()));
    }
  std::uint32_t number = 1;
  const auto see = [&](const test::FuseInput& frame, std::uint32_t count) {
    for (const std::uint32_t end = number + count; number < end; ++number) {
      bench.fuse(frame, number);
      bench.clean(number);
    }
  };
  see(wall, 12);
  see(disturbed, 2);
  EXPECT_GE(left_count(), 400);
  see(wall, 30);
  EXPECT_EQ(left_count(), 0);
}

TEST_F(CleanTest, UnstableSurfelsAreForgottenAndStableOnesAreNot) {
  const auto alone = [](float confidence, std::uint32_t observed) {
    Scene scene{.count = 0};
    scene.victim.confidence = confidence;
    scene.victim.observed_frame = observed;
    return scene;
  };
  EXPECT_TRUE(survives(alone(2.9f, kNow - 200)));
  EXPECT_FALSE(survives(alone(2.9f, kNow - 201)));
  EXPECT_TRUE(survives(alone(3, 1)));
  EXPECT_TRUE(survives(alone(0.1f, kNow)));
}

// There a block has its turn every sixteenth time only.
TEST_F(CleanTest, AgeCountsOutsideTheViewToo) {
  for (const Vector3d& position : {Vector3d(0, 0, -1), Vector3d(5, 0, 1), Vector3d(0, 0, 0.01)}) {
    Scene scene{.count = 0};
    scene.victim.position_in_submap_m = position.cast<float>();
    scene.victim.observed_frame = kNow - 1;
    EXPECT_TRUE(survives(scene));
    scene.victim.observed_frame = 1;
    test::upload(surfels_of(scene), bench.store);
    for (std::uint32_t frame = kNow; frame < kNow + 16; ++frame) bench.clean(frame);
    EXPECT_EQ(bench.store.download()[0].confidence, 0);
    EXPECT_EQ(bench.store.alive_count(), 0u);
    test::expect_consistent(bench.store);
  }
}

TEST_F(CleanTest, ImpossibleCurvaturesAreRemoved) {
  for (const float curvature_per_m : {299.0f, 301.0f, -299.0f, -301.0f}) {
    Scene scene{.count = 0};
    scene.victim.confidence = 50;
    scene.victim.curvature_max_per_m = std::max(curvature_per_m, 0.0f);
    scene.victim.curvature_min_per_m = std::min(curvature_per_m, 0.0f);
    EXPECT_EQ(survives(scene), std::abs(curvature_per_m) < 300) << curvature_per_m;
  }
}

// What is removed in this frame was not observed in it. Whoever looks at a neighbour must not take
// the one for the other, or the outcome hangs on which thread comes first.
TEST_F(CleanTest, WhatGoesNowIsNoWitness) {
  const Scene scene{.gap_m = 0.2, .background_observed = kNow - 1};
  std::vector<Surfel> surfels = surfels_of(scene);
  const Surfel victim = surfels[0];
  surfels.erase(surfels.begin());
  for (Surfel& s : surfels) s.curvature_max_per_m = 400;  // these go
  // Free ones in between: other workgroups, much later.
  surfels.resize(20'000);
  surfels.push_back(victim);
  test::upload(surfels, bench.store);
  bench.clean(kNow);
  test::expect_consistent(bench.store);
  const std::vector<Surfel> after = bench.store.download();
  EXPECT_EQ(after[0].confidence, 0);
  EXPECT_EQ(after[0].observed_frame, kNow);
  EXPECT_GT(after.back().confidence, 0);
}

TEST_F(CleanTest, SurvivorsAreNotTouched) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Surfel> before;
  for (int i = 0; i < 5000; ++i) {
    Surfel s = surfel_seen_at(64 * unit(random), 64 * unit(random), 1 + 0.05 * unit(random),
                              10 * unit(random), 50 + static_cast<std::uint32_t>(random() % 250));
    s.normal_in_submap = Eigen::Vector3f(unit(random), unit(random), 2).normalized();
    before.push_back(s);
  }
  test::upload(before, bench.store);
  before = bench.store.download();
  bench.clean(kNow);
  test::expect_consistent(bench.store);
  const std::vector<Surfel> after = bench.store.download();
  ASSERT_EQ(after.size(), before.size());
  std::size_t removed_count = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    removed_count += after[i].confidence <= 0 ? 1 : 0;
    if (after[i].confidence <= 0) continue;
    ASSERT_EQ(after[i].confidence, before[i].confidence);
    ASSERT_EQ(after[i].position_in_submap_m, before[i].position_in_submap_m);
    ASSERT_EQ(after[i].normal_in_submap, before[i].normal_in_submap);
    ASSERT_EQ(after[i].observed_frame, before[i].observed_frame);
  }
  EXPECT_GT(removed_count, 100u);
  EXPECT_LT(removed_count, 4900u);
}

// Frames that contradict each other: growing, shrinking and reusing slots.
std::vector<Surfel> after_many_frames(gpu::Device& device, std::uint32_t frame_count) {
  MapOptions options = cleaning();
  options.max_unstable_age_frames = 3;
  options.stable_confidence = 1.5;
  MapBench bench(device, kCamera, options);
  std::mt19937 random(7);
  std::uint32_t most_free = 0;
  for (std::uint32_t number = 1; number <= frame_count; ++number) {
    test::FuseInput frame = test::frontal_frame(kCamera, 1, 0.8f);
    const float wall_m = number % 6 < 3 ? 1.0f : 1.3f;
    for (std::size_t i = 0; i < frame.surface.size(); ++i)
      frame.surface.depth_m[i] = frame.raw_depth_m[i] =
          random() % 5 == 0 ? 0.0f : wall_m + 0.02f * static_cast<float>(random() % 100) / 100;
    bench.fuse(frame, number);
    bench.clean(number);
    test::expect_consistent(bench.store);
    EXPECT_GT(bench.store.alive_count(), 0u);
    most_free = std::max(most_free, bench.store.slot_count() - bench.store.alive_count());
  }
  EXPECT_GT(most_free, 100u) << "nothing was ever removed";
  EXPECT_LT(bench.store.slot_count(), 3u * 64 * 64) << "slots are used again";
  return bench.store.download();
}

TEST_F(CleanTest, CountersStayConsistentAndRunsAreAlike) {
  const std::vector<Surfel> first = after_many_frames(device(), 16),
                            second = after_many_frames(device(), 16);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].position_in_submap_m, second[i].position_in_submap_m) << i;
    ASSERT_EQ(first[i].normal_in_submap, second[i].normal_in_submap) << i;
    ASSERT_EQ(first[i].confidence, second[i].confidence) << i;
    ASSERT_EQ(first[i].observed_frame, second[i].observed_frame) << i;
  }
}

}  // namespace
}  // namespace hermite::map::clean_test
