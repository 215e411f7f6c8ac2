#include "core/map/surfel_block.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace hermite::map::surfel_block_test {
namespace {

// A block of a submap with `count` surfels, in every other slot, along x; each has a creation frame
// of its own.
SurfelBlock block_of(std::uint32_t submap, std::uint32_t count, std::uint32_t first_created,
                     float first_x_m = 0) {
  SurfelBlock block = empty_block({9, 1});
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t slot = 2 * i;
    Surfel surfel;
    surfel.normal_in_submap = {0, 0, 1};
    surfel.submap = submap;
    block.positions[slot] = {first_x_m + 0.03f * static_cast<float>(i), 0, 0, 1};
    block.attributes[slot] = pack_attributes(surfel);
    block.times[slot] = {first_created + i, 0};
  }
  describe(block);
  return block;
}

TEST(SurfelBlock, IsDescribedByItsLiveSurfels) {
  const SurfelBlock block = block_of(7, 20, 0);
  EXPECT_EQ(block.alive_count, 20u);
  EXPECT_EQ(block.submap, 7u);
  EXPECT_EQ(surfels_of(block).size(), kSlotsPerBlock);
  EXPECT_EQ(surfels_of(block)[2].created_frame, 1u);
}

TEST(SurfelBlock, EmptyItHasChangedWhenItWasMoved) {
  const SurfelBlock block = empty_block({3, 8});
  EXPECT_EQ(block.alive_count, 0u);
  EXPECT_EQ(block.name.number, 3u);
  EXPECT_EQ(block.changed_frame, 8u);
  for (const Surfel& surfel : surfels_of(block)) EXPECT_EQ(surfel.confidence, 0);
}

TEST(SurfelBlock, RegroupedAreFewAndOfOneSubmapEach) {
  const std::vector<SurfelBlock> sparse{block_of(1, 100, 0), block_of(0, 100, 100),
                                        block_of(1, 100, 200), block_of(1, 100, 300)};
  const std::vector<SurfelBlock> blocks = regrouped(sparse, 5);
  ASSERT_EQ(blocks.size(), 3u);
  EXPECT_EQ(blocks[0].submap, 0u);
  EXPECT_EQ(blocks[0].alive_count, 100u);
  EXPECT_EQ(blocks[1].submap, 1u);
  EXPECT_EQ(blocks[1].alive_count, kSlotsPerBlock);
  EXPECT_EQ(blocks[2].alive_count, 300 - kSlotsPerBlock);
  std::vector<bool> is_there(400, false);
  for (const SurfelBlock& block : blocks) {
    EXPECT_EQ(block.name.moved_frame, 5u);
    EXPECT_EQ(block.changed_frame, 5u);
    for (const Surfel& surfel : surfels_of(block)) {
      if (surfel.confidence == 0) continue;
      EXPECT_EQ(surfel.submap, block.submap);
      EXPECT_FALSE(is_there[surfel.created_frame]);
      is_there[surfel.created_frame] = true;
    }
    EXPECT_EQ(block.bounds.reach[0], bounds_of(surfels_of(block)).front().reach[0]);
  }
  EXPECT_EQ(is_there, std::vector<bool>(400, true));
}

TEST(SurfelBlock, RegroupedNeighboursStayTogether) {
  // Two clusters, in blocks that have some of both.
  const std::vector<SurfelBlock> sparse{block_of(0, 128, 0, -4), block_of(0, 128, 128, 2),
                                        block_of(0, 128, 256, -4), block_of(0, 128, 384, 2)};
  const std::vector<SurfelBlock> blocks = regrouped(sparse, 5);
  ASSERT_EQ(blocks.size(), 2u);
  for (const shared::vec4& p : blocks[0].positions) EXPECT_LT(p.x, 0);
  for (const shared::vec4& p : blocks[1].positions) EXPECT_GT(p.x, 0);
}

TEST(SurfelBlock, OfNoneThereAreNone) {
  EXPECT_TRUE(regrouped({}, 5).empty());
  EXPECT_TRUE(regrouped({empty_block({})}, 5).empty());
}

std::string saved(const SurfelBlock& block) {
  ByteWriter bytes;
  save(bytes, block);
  return bytes.take();
}

bool is_restored(const SurfelBlock& block, std::size_t submap_count) {
  const std::string state = saved(block);
  ByteReader bytes(state);
  SurfelBlock restored;
  restore(bytes, restored, submap_count);
  return bytes.ok() && bytes.at_end() && saved(restored) == state &&
         restored.alive_count == block.alive_count && restored.submap == block.submap;
}

TEST(SurfelBlock, IsRestoredUnlessItIsImpossible) {
  const SurfelBlock right = block_of(2, 50, 0);
  EXPECT_TRUE(is_restored(right, 3));
  EXPECT_FALSE(is_restored(right, 2)) << "its submap does not exist";
  SurfelBlock cut = right, nowhere = right;
  cut.times.pop_back();
  nowhere.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_restored(cut, 3));
  EXPECT_FALSE(is_restored(nowhere, 3));
}

}  // namespace
}  // namespace hermite::map::surfel_block_test
