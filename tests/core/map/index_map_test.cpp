#include "core/map/index_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/frame/shared_transform.h"
#include "core/map/visible_blocks.h"
#include "tests/reference/map_twin.h"
#include "tests/support/gpu_test.h"
#include "tests/support/index_slots.h"

namespace hermite::map::index_map_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::MapView;

const Camera kCamera{61, 43, 50, 52, 29.4, 20.7, 1000};
constexpr double kLowest = 0;  // no limit on confidence

Surfel surfel_at(const Vector3d& position_m, float confidence = 1) {
  Surfel s;
  s.position_in_submap_m = position_m.cast<float>();
  s.normal_in_submap = Vector3f::UnitZ();
  s.radius_m = 0.05f;
  s.confidence = confidence;
  return s;
}

// On the ray of a pixel, where (u, v) need not be whole.
Surfel surfel_seen_at(double u, double v, double depth_m, float confidence = 1) {
  return surfel_at(kCamera.unproject(u, v, depth_m), confidence);
}

class IndexMapTest : public test::GpuTest {
 protected:
  IndexMapTest()
      : store(device()),
        visible(device(), MapOptions{}),
        map(device(), frame::intrinsics_of(kCamera)) {
    view.camera = frame::intrinsics_of(kCamera);
  }

  std::vector<std::uint32_t> build(double min_confidence = kLowest) {
    gpu::Commands commands(device());
    visible.list(commands, store, view.camera, 1);
    map.build(commands, store, view.camera, min_confidence);
    commands.submit_and_wait();
    return test::slots_of(map);
  }
  std::vector<std::uint32_t> build(const std::vector<Surfel>& surfels,
                                   double min_confidence = kLowest) {
    test::upload(surfels, store);
    store.set_camera(Rigid3{});
    return build(min_confidence);
  }
  static std::uint32_t at(const std::vector<std::uint32_t>& ids, int x, int y) {
    return ids[static_cast<std::size_t>(y) * kCamera.width + static_cast<std::size_t>(x)];
  }

  SurfelStore store;
  VisibleBlocks visible;
  IndexMap map;
  MapView view;
};

// True where floats and doubles might disagree about the pixel.
bool between_pixels(const MapView& view, const Surfel& surfel) {
  const Vector3d p = view.position_m(surfel);
  const double u = view.camera.fx * p.x() / p.z() + view.camera.cx,
               v = view.camera.fy * p.y() / p.z() + view.camera.cy;
  const auto close = [](double x) { return std::abs(x - std::floor(x) - 0.5) < 1e-3; };
  return close(u) || close(v) || std::abs(p.z()) < 0.1 || std::abs(p.z() - 20) < 0.1;
}

// All around the camera, near and far, a fifth of them free, some exactly on top of an earlier one.
std::vector<Surfel> random_surfels(std::size_t count, const MapView& view, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Surfel> surfels;
  while (surfels.size() < count) {
    const double z = 12 * (unit(random) + 0.8);
    Surfel s = surfel_at({0.8 * z * unit(random), 0.6 * z * unit(random), z});
    s.confidence = static_cast<float>(std::max(0.0, 5 * (unit(random) + 0.6)));
    s.submap = static_cast<std::uint32_t>(random() % view.camera_from_submap.size());
    if (!surfels.empty() && random() % 10 == 0) {
      const Surfel& other = surfels[random() % surfels.size()];
      s.position_in_submap_m = other.position_in_submap_m;
      s.submap = other.submap;
    }
    if (!between_pixels(view, s)) surfels.push_back(s);
  }
  return surfels;
}

TEST_F(IndexMapTest, ThousandsOfSurfelsAgreeWithTheTwin) {
  const Rigid3 world_from_camera =
      exp_se3((Vector6d() << 0.1, -0.2, 0.05, 0.2, -0.3, 0.1).finished());
  view.camera_from_submap = {inverse(world_from_camera)};
  const std::vector<Surfel> surfels = random_surfels(20'000, view, 1);
  test::upload(surfels, store);
  store.set_camera(world_from_camera);
  for (const double min_confidence : {0.0, 3.0}) {
    const std::vector<std::uint32_t> expected = test::index_map_twin(surfels, view, min_confidence);
    EXPECT_EQ(build(min_confidence), expected) << min_confidence;
    EXPECT_GT(expected.size() -
                  static_cast<std::size_t>(std::count(expected.begin(), expected.end(), kNoSurfel)),
              1000u);
  }
}

TEST_F(IndexMapTest, OnePassAndTwoMakeTheSameMap) {
  if (!device().info().has_64_bit_atomics) GTEST_SKIP() << "the device has no 64-bit atomics";
  test::upload(random_surfels(20'000, view, 3), store);
  store.set_camera(Rigid3{});
  const auto slots = [&](int passes) {
    map = IndexMap(device(), frame::intrinsics_of(kCamera), passes);
    return build();
  };
  const std::vector<std::uint32_t> in_one = slots(1);
  const std::vector<shared::NearestSurfel> nearest = map.nearest().download();
  EXPECT_EQ(slots(2), in_one);
  EXPECT_TRUE(std::ranges::equal(map.nearest().download(), nearest, {},
                                 &shared::NearestSurfel::depth_bits,
                                 &shared::NearestSurfel::depth_bits));
}

TEST_F(IndexMapTest, SubmapsAreSeenWithTheirOwnPoses) {
  view.camera_from_submap = {exp_se3((Vector6d() << 0.3, 0, 0, 0, 0.1, 0).finished()),
                             exp_se3((Vector6d() << -2, 0.5, 1, -0.4, 0.8, 1).finished())};
  const std::vector<Surfel> surfels = random_surfels(20'000, view, 2);
  test::upload(surfels, store);
  store.camera_from_submap = gpu::Buffer<shared::Transform>(device(), 2, "test");
  store.camera_from_submap.upload(std::vector<shared::Transform>{
      frame::to_shared(view.camera_from_submap[0]), frame::to_shared(view.camera_from_submap[1])});
  EXPECT_EQ(build(), test::index_map_twin(surfels, view, kLowest));
}

TEST_F(IndexMapTest, TheNearestWinsAndOfEqualOnesTheLowestSlot) {
  // The first three are in one pixel.
  const std::vector<std::uint32_t> ids =
      build({surfel_seen_at(5, 6, 2), surfel_seen_at(5.2, 6.3, 1.5), surfel_seen_at(4.8, 5.7, 1.6),
             surfel_seen_at(20, 20, 3), surfel_seen_at(20, 20, 3), surfel_seen_at(20, 20, 3)});
  EXPECT_EQ(at(ids, 5, 6), 1u);
  EXPECT_EQ(at(ids, 20, 20), 3u);
  EXPECT_EQ(std::count(ids.begin(), ids.end(), kNoSurfel),
            static_cast<std::ptrdiff_t>(ids.size()) - 2);
}

TEST_F(IndexMapTest, APixelReachesHalfAPixelAroundItsCentre) {
  const std::vector<std::uint32_t> ids = build(
      {surfel_seen_at(10.49, 10, 1), surfel_seen_at(12.51, 10, 1), surfel_seen_at(0, -0.49, 1),
       surfel_seen_at(-0.51, 5, 1), surfel_seen_at(60.49, 42.49, 1), surfel_seen_at(60.51, 3, 1)});
  EXPECT_EQ(at(ids, 10, 10), 0u);
  EXPECT_EQ(at(ids, 13, 10), 1u);
  EXPECT_EQ(at(ids, 0, 0), 2u);
  EXPECT_EQ(at(ids, 60, 42), 4u);
  EXPECT_EQ(std::count(ids.begin(), ids.end(), kNoSurfel),
            static_cast<std::ptrdiff_t>(ids.size()) - 4);
}

TEST_F(IndexMapTest, FreeWeakHiddenAndFarSurfelsAreNotSeen) {
  const std::vector<Surfel> surfels{surfel_seen_at(1, 1, 1, 0), surfel_seen_at(3, 1, 1, 2.99f),
                                    surfel_seen_at(5, 1, 1, 3), surfel_at({0, 0, -1}),
                                    surfel_at({0, 0, 0}),       surfel_at({0, 0, 0.04}),
                                    surfel_seen_at(7, 1, 20.5)};
  const std::vector<std::uint32_t> strong = build(surfels, 3);
  EXPECT_EQ(at(strong, 5, 1), 2u);
  EXPECT_EQ(std::count(strong.begin(), strong.end(), kNoSurfel),
            static_cast<std::ptrdiff_t>(strong.size()) - 1);
  const std::vector<std::uint32_t> all = build(surfels);
  EXPECT_EQ(at(all, 3, 1), 1u);
  EXPECT_EQ(std::count(all.begin(), all.end(), kNoSurfel),
            static_cast<std::ptrdiff_t>(all.size()) - 2);
}

TEST_F(IndexMapTest, AnEmptyMapShowsNothingAndLeavesNothingBehind) {
  build({surfel_seen_at(5, 5, 1)});
  const std::vector<std::uint32_t> ids = build(std::vector<Surfel>{});
  EXPECT_EQ(std::count(ids.begin(), ids.end(), kNoSurfel), static_cast<std::ptrdiff_t>(ids.size()));
}

}  // namespace
}  // namespace hermite::map::index_map_test
