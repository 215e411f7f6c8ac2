#include "core/map/surfel_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/support/gpu_test.h"
#include "tests/support/map_bench.h"
#include "tests/support/packing.h"
#include "tests/support/surface_image.h"

namespace hermite::map::surfel_store_test {
namespace {

using SurfelStoreTest = test::GpuTest;

std::vector<Surfel> random_surfels(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Surfel> surfels(count);
  for (Surfel& s : surfels) {
    s.position_in_submap_m = {9 * unit(random), 9 * unit(random), 9 * unit(random)};
    s.normal_in_submap = Eigen::Vector3f(unit(random), unit(random), unit(random)).normalized();
    s.radius_m = 0.05f + 0.04f * unit(random);
    s.confidence = std::max(0.0f, 10 * unit(random));
    s.curvature_max_per_m = 300 * unit(random);
    s.curvature_min_per_m = 300 * unit(random);
    s.r = static_cast<float>(random() % 2041) / 8;
    s.g = static_cast<float>(random() % 2041) / 8;
    s.b = static_cast<float>(random() % 1021) / 4;
    s.submap = static_cast<std::uint32_t>(random() & 0xffffu);
    s.created_frame = static_cast<std::uint32_t>(random());
    s.observed_frame = static_cast<std::uint32_t>(random());
  }
  return surfels;
}

void expect_same(const Surfel& actual, const Surfel& expected, std::size_t slot) {
  ASSERT_EQ(actual.position_in_submap_m, expected.position_in_submap_m) << slot;
  ASSERT_EQ(actual.confidence, expected.confidence) << slot;
  ASSERT_LT((actual.normal_in_submap - expected.normal_in_submap).norm(), test::kNormalLoss)
      << slot;
  ASSERT_NEAR(actual.radius_m, expected.radius_m, test::kHalfLoss * expected.radius_m) << slot;
  ASSERT_NEAR(actual.curvature_max_per_m, expected.curvature_max_per_m,
              test::kHalfLoss * std::abs(expected.curvature_max_per_m))
      << slot;
  ASSERT_NEAR(actual.curvature_min_per_m, expected.curvature_min_per_m,
              test::kHalfLoss * std::abs(expected.curvature_min_per_m))
      << slot;
  ASSERT_TRUE(actual.r == expected.r && actual.g == expected.g && actual.b == expected.b) << slot;
  ASSERT_EQ(actual.submap, expected.submap) << slot;
  ASSERT_EQ(actual.created_frame, expected.created_frame) << slot;
  ASSERT_EQ(actual.observed_frame, expected.observed_frame) << slot;
}

TEST_F(SurfelStoreTest, StartsEmpty) {
  const SurfelStore store(device());
  EXPECT_EQ(store.slot_count(), 0u);
  EXPECT_EQ(store.alive_count(), 0u);
  EXPECT_TRUE(store.download().empty());
  ASSERT_EQ(store.world_from_submap().size(), 1u);
}

TEST_F(SurfelStoreTest, DownloadsWhatWasStored) {
  SurfelStore store(device());
  const std::vector<Surfel> surfels = random_surfels(1000, 1);
  test::upload(surfels, store);
  const std::vector<Surfel> actual = store.download();
  ASSERT_EQ(actual.size(), surfels.size());
  for (std::size_t i = 0; i < actual.size(); ++i) expect_same(actual[i], surfels[i], i);
  EXPECT_EQ(store.slot_count(), 1000u);
  EXPECT_EQ(store.alive_count() + test::free_slots(store).size(), 1000u);
}

TEST_F(SurfelStoreTest, GrowsByHalfAndKeepsItsContent) {
  SurfelStore store(device());
  const std::uint32_t first = store.capacity();
  const std::vector<Surfel> surfels = random_surfels(2000, 2);
  test::upload(surfels, store);
  const std::vector<std::uint32_t> free = test::free_slots(store);
  store.reserve(first - 2000);
  EXPECT_EQ(store.capacity(), first) << "there was room";
  store.reserve(first - 1999);
  EXPECT_EQ(store.capacity(), first + first / 2);
  EXPECT_GE(store.positions.count(), store.capacity());
  EXPECT_GE(store.attributes.count(), store.capacity());
  EXPECT_GE(store.times.count(), store.capacity());
  EXPECT_GE(store.free_slots.count(), store.capacity());
  EXPECT_GE(store.group_counts.count(), (store.capacity() + 255) / 256);
  const std::vector<Surfel> actual = store.download();
  ASSERT_EQ(actual.size(), surfels.size());
  for (std::size_t i = 0; i < actual.size(); ++i) expect_same(actual[i], surfels[i], i);
  EXPECT_EQ(test::free_slots(store), free);
  store.reserve(2 * store.capacity());
  EXPECT_EQ(store.capacity(), 2048 + 3 * first)
      << "as much as asked for where half is not enough, in whole blocks of 256";
}

TEST_F(SurfelStoreTest, AppendsBehindAllInWholeBlocks) {
  SurfelStore store(device());
  std::vector<Surfel> first = random_surfels(300, 3), second = random_surfels(5, 4);
  for (std::vector<Surfel>* surfels : {&first, &second})
    for (Surfel& s : *surfels) s.confidence = 2;
  store.append(first);
  EXPECT_EQ(store.slot_count(), 300u);
  store.append(second);
  EXPECT_EQ(store.slot_count(), 517u);
  EXPECT_EQ(store.alive_count(), 305u);
  const std::vector<Surfel> actual = store.download();
  for (std::size_t i = 0; i < 300; ++i) expect_same(actual[i], first[i], i);
  for (std::size_t i = 300; i < 512; ++i) ASSERT_EQ(actual[i].confidence, 0);
  for (std::size_t i = 0; i < 5; ++i) expect_same(actual[512 + i], second[i], i);
}

// Surfels of submaps 0, 1, ... in blocks of their own, `count` each.
std::vector<Surfel> append_submaps(SurfelStore& store, std::uint32_t submap_count,
                                   std::uint32_t count) {
  std::vector<Surfel> all;
  store.set_submaps(std::vector<Rigid3>(submap_count));
  for (std::uint32_t submap = 0; submap < submap_count; ++submap) {
    std::vector<Surfel> surfels = random_surfels(count, submap + 10);
    for (Surfel& s : surfels) {
      s.submap = submap;
      s.confidence = 2;
      s.observed_frame = submap + 1;
    }
    store.append(surfels);
    all.insert(all.end(), surfels.begin(), surfels.end());
  }
  return all;
}

TEST_F(SurfelStoreTest, SubmapsWaitOnTheHostAndComeBackUnchanged) {
  SurfelStore store(device());
  append_submaps(store, 3, 600);
  const std::vector<NumberedSurfel> before = store.changed_blocks(0);
  ASSERT_EQ(before.size(), 3u * 3 * kSlotsPerBlock);
  const auto expect_as_before = [&] {
    EXPECT_EQ(store.surfel_count(), 1800);
    const std::vector<NumberedSurfel> now = store.changed_blocks(0);
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      ASSERT_EQ(now[i].number, before[i].number);
      expect_same(now[i].surfel, before[i].surfel, i);
    }
  };
  for (const SubmapSet& kept : {SubmapSet{false, true, false},
                                {true, false, false},
                                {true, true, true},
                                {false, false, false},
                                {true, false, true}}) {
    EXPECT_TRUE(store.keep(kept));
    const auto kept_count = static_cast<std::uint32_t>(std::count(kept.begin(), kept.end(), true));
    EXPECT_EQ(store.alive_count(), 600 * kept_count);
    EXPECT_EQ(store.slot_count(), 768 * kept_count);
    EXPECT_EQ(store.host_bytes() > 0, kept_count < 3);
    for (std::uint32_t submap = 0; submap < 3; ++submap)
      EXPECT_EQ(store.is_on_device(submap), kept[submap]);
    for (const Surfel& s : store.download()) EXPECT_TRUE(s.confidence == 0 || kept[s.submap]);
    expect_as_before();
  }
}

TEST_F(SurfelStoreTest, WhatDoesNotFitStaysWhereItIs) {
  SurfelStore store(device(), 5 * kSlotsPerBlock);
  append_submaps(store, 2, 300);  // two blocks each
  ASSERT_TRUE(store.keep({false, true}));
  std::vector<Surfel> more = random_surfels(600, 3);
  for (Surfel& s : more) s.submap = 1, s.confidence = 2, s.observed_frame = 7;
  store.append(more);  // three
  const std::vector<NumberedSurfel> before = store.changed_blocks(0);
  EXPECT_FALSE(store.keep({true, true}));
  EXPECT_FALSE(store.is_on_device(0));
  EXPECT_EQ(store.alive_count(), 900u);
  EXPECT_EQ(store.surfel_count(), 1200);
  const std::vector<NumberedSurfel> after = store.changed_blocks(0);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    ASSERT_EQ(after[i].number, before[i].number);
    expect_same(after[i].surfel, before[i].surfel, i);
  }
  EXPECT_TRUE(store.keep({true, false}));
  EXPECT_EQ(store.alive_count(), 300u);
}

TEST_F(SurfelStoreTest, BlocksThatComeLaterHaveOtherNumbers) {
  SurfelStore store(device());
  append_submaps(store, 2, 300);  // blocks 0 and 1, 2 and 3
  store.keep({false, true});
  std::vector<Surfel> more = random_surfels(10, 3);
  for (Surfel& s : more) s.submap = 1, s.confidence = 2, s.observed_frame = 7;
  store.append(more);
  const std::vector<NumberedSurfel> changed = store.changed_blocks(6);
  ASSERT_EQ(changed.size(), kSlotsPerBlock);
  EXPECT_EQ(changed[0].number, 4 * kSlotsPerBlock);
  store.keep({true, true});
  std::vector<std::uint32_t> numbers;
  for (const NumberedSurfel& s : store.changed_blocks(0))
    if (s.number % kSlotsPerBlock == 0) numbers.push_back(s.number / kSlotsPerBlock);
  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

TEST_F(SurfelStoreTest, OnlyChangedBlocksAreRead) {
  SurfelStore store(device());
  append_submaps(store, 3, 300);
  EXPECT_EQ(store.changed_blocks(0).size(), 6u * kSlotsPerBlock);
  EXPECT_EQ(store.changed_blocks(2).size(), 2u * kSlotsPerBlock);
  EXPECT_TRUE(store.changed_blocks(3).empty());
  store.keep({true, true, false});
  EXPECT_EQ(store.changed_blocks(2).size(), 2u * kSlotsPerBlock) << "on the host too";
}

// Of all that live, by place. Each has a creation frame of its own, which tells it from the others.
using Places = std::map<std::uint32_t, Surfel>;

Places living(const std::vector<NumberedSurfel>& surfels) {
  Places places;
  for (const NumberedSurfel& s : surfels)
    if (s.surfel.confidence > 0) places[s.number] = s.surfel;
  return places;
}

std::vector<Surfel> by_creation(const Places& places) {
  std::vector<Surfel> surfels;
  for (const auto& [number, surfel] : places) surfels.push_back(surfel);
  std::sort(surfels.begin(), surfels.end(),
            [](const Surfel& a, const Surfel& b) { return a.created_frame < b.created_frame; });
  return surfels;
}

TEST_F(SurfelStoreTest, CompactingKeepsWhatLivesAndSaysWhereItIs) {
  constexpr std::uint32_t kSubmaps = 3, kCount = 12'000, kFrame = 7;
  SurfelStore store(device(), 1u << 16);
  store.set_submaps(std::vector<Rigid3>(kSubmaps));
  std::uint32_t next = 0, alive_count = 0;
  std::vector<shared::vec4> positions;
  for (std::uint32_t submap = 0; submap < kSubmaps; ++submap) {
    std::vector<Surfel> surfels = random_surfels(kCount, submap + 10);
    for (Surfel& s : surfels)
      s.submap = submap, s.confidence = 2, s.observed_frame = 1, s.created_frame = next++;
    store.append(surfels);
  }
  EXPECT_FALSE(store.is_sparse());
  // One in ten lives, but of the first two blocks all.
  positions = store.positions.download(store.slot_count());
  for (std::size_t slot = 2 * kSlotsPerBlock; slot < positions.size(); ++slot)
    if (slot % 10 != 0) positions[slot].w = 0;
  for (const shared::vec4& p : positions) alive_count += p.w > 0 ? 1 : 0;
  store.positions.upload(positions);
  shared::MapState state = store.state.download(1)[0];
  state.alive_count = alive_count;
  store.state.upload(std::vector{state});
  EXPECT_TRUE(store.is_sparse());

  const Places before = living(store.changed_blocks(0));
  store.compact(kFrame);
  const Places after = living(store.changed_blocks(0));
  EXPECT_FALSE(store.is_sparse());
  EXPECT_EQ(store.alive_count(), alive_count);
  EXPECT_LE(store.slot_count(), alive_count + kSlotsPerBlock * kSubmaps);
  test::expect_consistent(store);
  const std::vector<Surfel> old = by_creation(before), now = by_creation(after);
  ASSERT_EQ(now.size(), old.size());
  for (std::size_t i = 0; i < now.size(); ++i) expect_same(now[i], old[i], i);
  for (std::uint32_t number = 0; number < 2 * kSlotsPerBlock; ++number)
    ASSERT_TRUE(after.contains(number)) << "full blocks stay";

  // Who follows the changes has the same.
  Places mirror = before;
  for (const NumberedSurfel& s : store.changed_blocks(kFrame - 1)) {
    if (s.changed_frame < kFrame) continue;
    if (s.surfel.confidence > 0)
      mirror[s.number] = s.surfel;
    else
      mirror.erase(s.number);
  }
  ASSERT_EQ(mirror.size(), after.size());
  for (const auto& [number, surfel] : after) ASSERT_TRUE(mirror.contains(number)) << number;
  EXPECT_TRUE(store.changed_blocks(kFrame).empty());
}

TEST_F(SurfelStoreTest, CompactingAnEmptyOrFullMapIsNothing) {
  SurfelStore store(device());
  store.compact(1);
  EXPECT_EQ(store.slot_count(), 0u);
  append_submaps(store, 1, 2 * kSlotsPerBlock);
  store.compact(9);
  EXPECT_EQ(store.slot_count(), 2 * kSlotsPerBlock);
  EXPECT_TRUE(store.changed_blocks(8).empty());
}

TEST_F(SurfelStoreTest, StaysWithinItsBound) {
  SurfelStore store(device(), 4096 + 100);
  EXPECT_EQ(store.capacity(), 4096u);
  append_submaps(store, 4, 1024);
  EXPECT_FALSE(store.has_room_for(1));
  EXPECT_THROW(store.reserve(1), SetupError);
  store.keep({false, false, false, true});
  EXPECT_TRUE(store.has_room_for(3072));
  EXPECT_FALSE(store.has_room_for(3073));
  store.reserve(3072);
  EXPECT_EQ(store.capacity(), 4096u);
}

TEST_F(SurfelStoreTest, SaysWhenAMapIsFull) {
  SurfelStore store(device());
  try {
    store.reserve(kMaxStoreSlots + 1);
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("at most 16776960"));
  }
}

TEST_F(SurfelStoreTest, TheCameraGoesToThePasses) {
  SurfelStore store(device());
  const Rigid3 world_from_camera = exp_se3((Vector6d() << 1, 2, 3, 0.1, 0.2, 0.3).finished());
  store.set_camera(world_from_camera);
  const shared::Transform t = store.camera_from_submap.download()[0];
  const Eigen::Matrix4d expected = inverse(world_from_camera).matrix();
  const shared::vec4 rows[3] = {t.row0, t.row1, t.row2};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(rows[i].x, expected(i, 0), 1e-6);
    EXPECT_NEAR(rows[i].y, expected(i, 1), 1e-6);
    EXPECT_NEAR(rows[i].z, expected(i, 2), 1e-6);
    EXPECT_NEAR(rows[i].w, expected(i, 3), 1e-6);
  }
}

}  // namespace
}  // namespace hermite::map::surfel_store_test
