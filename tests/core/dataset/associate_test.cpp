#include "core/dataset/associate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::dataset {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Associate, PairsTheNearestTimes) {
  EXPECT_THAT(*associate_by_time({0.000, 0.033, 0.066}, {0.010, 0.036, 0.070}),
              ElementsAre(IndexPair{0, 0}, IndexPair{1, 1}, IndexPair{2, 2}));
}

TEST(Associate, UsesEachEntryOnce) {
  // Both want the entry at 0.010; the nearer one gets it and the other one takes the next best.
  EXPECT_THAT(*associate_by_time({0.000, 0.012}, {0.010, 0.015}),
              ElementsAre(IndexPair{0, 1}, IndexPair{1, 0}));
  EXPECT_THAT(*associate_by_time({0.000, 0.012}, {0.010}), ElementsAre(IndexPair{1, 0}));
}

TEST(Associate, TheGapIsTwentyMillisecondsInclusive) {
  EXPECT_THAT(*associate_by_time({1305031233.500}, {1305031233.520}), ElementsAre(IndexPair{0, 0}));
  EXPECT_THAT(*associate_by_time({1305031233.500}, {1305031233.5201}), IsEmpty());
  EXPECT_THAT(*associate_by_time({1305031233.520}, {1305031233.500}), ElementsAre(IndexPair{0, 0}));
  EXPECT_THAT(*associate_by_time({0.0}, {0.04}, 0.05), ElementsAre(IndexPair{0, 0}));
}

TEST(Associate, TiesGoToTheEarlierEntries) {
  EXPECT_THAT(*associate_by_time({1.0}, {0.5, 1.5}, 0.75), ElementsAre(IndexPair{0, 0}));
}

TEST(Associate, EmptyListsGiveNoPairs) {
  EXPECT_THAT(*associate_by_time({}, {1.0}), IsEmpty());
  EXPECT_THAT(*associate_by_time({1.0}, {}), IsEmpty());
}

TEST(Associate, ListsThatAreNoTimeStampsAreRefusedBeforeTheyFillTheMemory) {
  const std::vector<double> all_at_once(2000, 1.0);
  const auto pairs = associate_by_time(all_at_once, all_at_once);
  ASSERT_FALSE(pairs.ok());
  EXPECT_EQ(pairs.error().code, ErrorCode::kTooLarge);
}

}  // namespace
}  // namespace hermite::dataset
