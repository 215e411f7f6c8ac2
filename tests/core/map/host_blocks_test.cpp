#include "core/map/host_blocks.h"

#include <gtest/gtest.h>

#include <string>

namespace hermite::map::host_blocks_test {
namespace {

SurfelBlock block(std::uint32_t number, std::uint32_t submap, std::uint32_t changed_frame) {
  SurfelBlock made = empty_block({number, 0});
  made.positions[0].w = 1;
  made.attributes[0].radius_submap = submap << 16;
  made.changed_frame = changed_frame;
  describe(made);
  return made;
}

// Two blocks of submap 2, one of submap 0.
HostBlocks three() {
  HostBlocks blocks;
  blocks.add(block(4, 2, 10));
  blocks.add(block(1, 0, 20));
  blocks.add(block(3, 2, 30));
  return blocks;
}

TEST(HostBlocks, AreFoundBySubmap) {
  const HostBlocks blocks = three();
  EXPECT_TRUE(blocks.has(0) && blocks.has(2));
  EXPECT_FALSE(blocks.has(1));
  EXPECT_EQ(blocks.alive_count(), 3);
  EXPECT_GT(blocks.bytes(), 3 * 256 * 40);
  EXPECT_EQ(blocks.count_of({false, true, true}), 2u);
  EXPECT_EQ(blocks.numbers(), (std::vector<std::uint32_t>{1, 4, 3}));
}

TEST(HostBlocks, LeaveWithTheirSubmap) {
  HostBlocks blocks = three();
  std::vector<SurfelBlock> taken{block(9, 1, 0)};
  blocks.take({false, false, true}, taken);
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_EQ(taken[1].name.number, 4u);
  EXPECT_EQ(taken[2].name.number, 3u);
  EXPECT_FALSE(blocks.has(2));
  EXPECT_EQ(blocks.alive_count(), 1);
}

TEST(HostBlocks, ChangedOnesAreCopied) {
  const HostBlocks blocks = three();
  std::vector<SurfelBlock> changed;
  blocks.copy_changed(10, changed);
  ASSERT_EQ(changed.size(), 2u);
  EXPECT_EQ(changed[0].name.number, 1u);
  EXPECT_EQ(changed[1].name.number, 3u);
  EXPECT_EQ(blocks.alive_count(), 3);
}

TEST(HostBlocks, AreRestoredIfTheirSubmapsExist) {
  ByteWriter saved;
  three().save(saved);
  const std::string state = saved.take();
  HostBlocks restored, lost;
  ByteReader bytes(state), again(state);
  restored.restore(bytes, 3);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  EXPECT_EQ(restored.numbers(), three().numbers());
  lost.restore(again, 2);
  EXPECT_FALSE(again.ok());
}

}  // namespace
}  // namespace hermite::map::host_blocks_test
