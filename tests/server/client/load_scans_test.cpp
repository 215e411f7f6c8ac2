#include "server/client/load_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace hermite::client::load_scans_test {
namespace {

using testing::ElementsAre;

TEST(LoadScans, SpreadViewersEvenly) {
  LoadScans scans;
  EXPECT_FALSE(scans.take());
  for (const char* id : {"a", "b", "c"}) scans.begin(id);
  std::map<std::string, int> viewers;
  for (int i = 0; i < 8; ++i) ++viewers[*scans.take()];
  EXPECT_THAT(viewers,
              ElementsAre(testing::Pair("a", 3), testing::Pair("b", 3), testing::Pair("c", 2)));
  EXPECT_EQ(scans.take(), "c");
  scans.give_back("b");
  EXPECT_EQ(scans.take(), "b");
}

TEST(LoadScans, ThatHaveEndedGetNoMoreViewers) {
  LoadScans scans;
  scans.begin("a");
  scans.begin("b");
  EXPECT_EQ(scans.take(), "a");
  scans.end("a");
  scans.give_back("a");
  EXPECT_EQ(scans.take(), "b");
  EXPECT_EQ(scans.take(), "b");
  EXPECT_THAT(scans.all(), ElementsAre("a", "b"));
}

}  // namespace
}  // namespace hermite::client::load_scans_test
