#include "core/map/slot_arrays.h"

#include <gtest/gtest.h>

#include <string>

namespace hermite::map::slot_arrays_test {
namespace {

// One per slot, observed in frames 1, 2 and so on.
std::vector<Surfel> surfels(std::uint32_t count) {
  std::vector<Surfel> made(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    made[i].position_in_submap_m = {0.01f * static_cast<float>(i), 0, 1};
    made[i].normal_in_submap = {0, 0, 1};
    made[i].confidence = 2;
    made[i].submap = 1;
    made[i].observed_frame = i + 1;
  }
  return made;
}

TEST(SlotArrays, HaveWhatIsPerSlotAndPerBlock) {
  const SlotArrays arrays = arrays_of(surfels(300));
  EXPECT_EQ(arrays.positions.size(), 300u);
  EXPECT_EQ(arrays.attributes.size(), 300u);
  EXPECT_EQ(arrays.times.size(), 300u);
  EXPECT_EQ(arrays.bounds.size(), 2u);
  EXPECT_EQ(arrays.changed_frames, (std::vector<shared::uint>{256, 300}));
}

TEST(SlotArrays, AreTakenApartIntoBlocksAndPutTogetherAgain) {
  const SlotArrays arrays = arrays_of(surfels(2 * kSlotsPerBlock));
  const std::vector<SurfelBlock> blocks{block_at(arrays, 0, {5, 0}), block_at(arrays, 1, {6, 70})};
  EXPECT_EQ(blocks[1].name.number, 6u);
  EXPECT_EQ(blocks[1].name.moved_frame, 70u);
  EXPECT_EQ(blocks[1].alive_count, kSlotsPerBlock);
  EXPECT_EQ(blocks[1].submap, 1u);
  EXPECT_EQ(surfels_of(blocks[1])[0].observed_frame, kSlotsPerBlock + 1);
  const SlotArrays again = arrays_of(blocks);
  EXPECT_EQ(again.positions.size(), arrays.positions.size());
  EXPECT_EQ(again.positions[300].x, arrays.positions[300].x);
  EXPECT_EQ(again.times[300].y, arrays.times[300].y);
  EXPECT_EQ(again.bounds[1].reach[0], arrays.bounds[1].reach[0]);
  EXPECT_EQ(again.changed_frames, arrays.changed_frames);
}

TEST(SlotArrays, FreeOnesHaveNoSurfels) {
  const SlotArrays arrays = free_arrays(2);
  EXPECT_EQ(arrays.positions.size(), 2 * kSlotsPerBlock);
  EXPECT_EQ(arrays.bounds.size(), 2u);
  EXPECT_EQ(block_at(arrays, 1, {}).alive_count, 0u);
}

// Two blocks of which the last three slots are free: two of them listed, for one zone.
SavedSlots saved_slots() {
  SavedSlots saved;
  std::vector<Surfel> all = surfels(2 * kSlotsPerBlock);
  for (std::size_t i = all.size() - 3; i < all.size(); ++i) all[i].confidence = 0;
  saved.arrays = arrays_of(all);
  saved.state.slot_count = 2 * kSlotsPerBlock;
  saved.state.alive_count = saved.state.slot_count - 3;
  saved.free_slots = {saved.state.slot_count - 1, saved.state.slot_count - 3};
  saved.state.free_count = 2;
  saved.state.zones[0] = {0, 2, 0, 0};
  return saved;
}

template <class Change>
bool is_right(Change change, std::size_t submap_count = 2) {
  SavedSlots saved = saved_slots();
  change(saved);
  const std::string nothing;
  ByteReader bytes(nothing);
  check_slots(bytes, saved, submap_count);
  return bytes.ok();
}

TEST(SlotArrays, OnlyAStateThatAgreesWithItselfIsRight) {
  EXPECT_TRUE(is_right([](SavedSlots&) {}));
  EXPECT_FALSE(is_right([](SavedSlots&) {}, 1)) << "a submap that does not exist";
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.state.slot_count += kSlotsPerBlock; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.arrays.times.pop_back(); }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.arrays.changed_frames.pop_back(); }));
  EXPECT_FALSE(
      is_right([](SavedSlots& saved) { saved.state.alive_count = saved.state.slot_count + 1; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.state.new_count = 1; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.state.free_count = 3; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.free_slots[0] = 5; })) << "in use";
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.free_slots[0] = saved.free_slots[1]; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.free_slots[0] = saved.state.slot_count; }));
  EXPECT_FALSE(is_right([](SavedSlots& saved) { saved.state.zones[0].free_begin = 1; }));
}

}  // namespace
}  // namespace hermite::map::slot_arrays_test
