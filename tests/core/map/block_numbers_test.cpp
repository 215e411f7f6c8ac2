#include "core/map/block_numbers.h"

#include <gtest/gtest.h>

#include <string>

namespace hermite::map::block_numbers_test {
namespace {

std::vector<SurfelBlock> blocks_with(const std::vector<std::uint32_t>& numbers) {
  std::vector<SurfelBlock> blocks;
  for (const std::uint32_t number : numbers) blocks.push_back(empty_block({number, 0}));
  return blocks;
}

// Of six blocks, 1 and 4 are elsewhere, 2 is gone and the others are on the device, 5 first; then a
// new one has come.
BlockNumbers rearranged() {
  BlockNumbers numbers;
  numbers.fix(6);
  numbers.place(blocks_with({5, 0, 3}));
  numbers.retire(2, 40);
  return numbers;
}

bool is_right(const BlockNumbers& numbers, std::size_t blocks_on_device,
              const std::vector<std::uint32_t>& elsewhere) {
  const std::string nothing;
  ByteReader bytes(nothing);
  numbers.check(bytes, blocks_on_device, elsewhere);
  return bytes.ok();
}

TEST(BlockNumbers, GoUpAsBlocksCome) {
  BlockNumbers numbers;
  EXPECT_EQ(numbers.name_of(3).number, 3u);
  numbers.fix(2);
  EXPECT_EQ(numbers.name_of(1).number, 1u);
  EXPECT_EQ(numbers.next(), 2u);
  EXPECT_EQ(numbers.name_of(2).number, 3u) << "that one is taken";
}

TEST(BlockNumbers, StayWithTheirBlocks) {
  const BlockNumbers numbers = rearranged();
  EXPECT_EQ(numbers.name_of(0).number, 5u);
  EXPECT_EQ(numbers.name_of(2).number, 3u);
  EXPECT_EQ(numbers.name_of(3).number, 6u) << "a new one";
  ASSERT_EQ(numbers.gone_blocks().size(), 1u);
  EXPECT_EQ(numbers.gone_blocks()[0].number, 2u);
  EXPECT_EQ(numbers.gone_blocks()[0].moved_frame, 40u);
}

TEST(BlockNumbers, OccurOnceEach) {
  const BlockNumbers numbers = rearranged();
  EXPECT_TRUE(is_right(numbers, 4, {1, 4}));
  EXPECT_FALSE(is_right(numbers, 4, {1, 3})) << "on the device as well";
  EXPECT_FALSE(is_right(numbers, 4, {1, 2})) << "gone";
  EXPECT_FALSE(is_right(numbers, 4, {1, 6})) << "not yet given";
  EXPECT_FALSE(is_right(numbers, 2, {1, 4})) << "fewer blocks than numbers";
  EXPECT_FALSE(is_right(numbers, std::size_t{1} << 20, {1, 4})) << "more blocks than numbers";
}

TEST(BlockNumbers, AreRestored) {
  const BlockNumbers numbers = rearranged();
  ByteWriter saved;
  numbers.save(saved);
  const std::string state = saved.take();
  BlockNumbers restored;
  ByteReader bytes(state);
  restored.restore(bytes);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  for (std::uint32_t place = 0; place < 5; ++place)
    EXPECT_EQ(restored.name_of(place).number, numbers.name_of(place).number);
  EXPECT_EQ(restored.gone_blocks().size(), 1u);
}

}  // namespace
}  // namespace hermite::map::block_numbers_test
