#include "core/base/disjoint_sets.h"

#include <gtest/gtest.h>

namespace hermite {
namespace {

TEST(DisjointSets, GrowTogetherUnderTheLowest) {
  DisjointSets sets(6);
  EXPECT_EQ(sets.root(4), 4u);
  sets.join(5, 3);
  sets.join(4, 5);
  EXPECT_EQ(sets.root(4), 3u);
  sets.join(1, 4);
  for (const std::uint32_t i : {1u, 3u, 4u, 5u}) EXPECT_EQ(sets.root(i), 1u);
  EXPECT_EQ(sets.root(0), 0u);
  EXPECT_EQ(sets.root(2), 2u);
}

}  // namespace
}  // namespace hermite
