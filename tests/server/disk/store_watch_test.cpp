#include "server/disk/store_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "server/store/store.h"
#include "tests/support/store_rows.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

class StoreWatchTest : public testing::Test {
 protected:
  void SetUp() override {
    Store store(path_);
    for (int i = 0; i < 200; ++i)
      ASSERT_TRUE(store.scans.add(test::scan_row("scan " + std::to_string(i))).ok());
  }
  // A page of the file is overwritten behind the store's back, as a disk does it that forgets.
  void damage() const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4096 + 8);
    file << std::string(2000, '\x7f');
  }
  // The checks that are due at that time, to their end.
  static void check(StoreWatch& watch, StoreWatch::Clock::time_point now) {
    watch.tick(now);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    watch.tick(now);
  }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "db";
  const StoreWatch::Clock::time_point start_ = StoreWatch::Clock::now();
};

TEST_F(StoreWatchTest, SaysNothingOfAWholeOne) {
  const Store store(path_);
  StoreWatch watch(store);
  check(watch, start_);
  EXPECT_FALSE(watch.damage());
}

TEST_F(StoreWatchTest, SeesDamageFromBeforeTheStart) {
  damage();
  const Store store(path_);
  StoreWatch watch(store);
  check(watch, start_);
  ASSERT_TRUE(watch.damage());
  EXPECT_THAT(*watch.damage(), HasSubstr("restore a backup"));
}

TEST_F(StoreWatchTest, LooksAgainAfterAWeekAndNotBefore) {
  const Store store(path_);
  StoreWatch watch(store);
  check(watch, start_);
  damage();
  check(watch, start_ + kCheckPeriod - std::chrono::minutes(1));
  EXPECT_FALSE(watch.damage());
  check(watch, start_ + kCheckPeriod + std::chrono::minutes(1));
  EXPECT_TRUE(watch.damage());
}

TEST_F(StoreWatchTest, WhatCannotBeToldIsNoDamageAndIsAskedAgainSoon) {
  const Store store(path_);
  StoreWatch watch(store);
  const std::string elsewhere = folder_ / "elsewhere";
  std::filesystem::rename(path_, elsewhere);
  check(watch, start_);
  EXPECT_FALSE(watch.damage());
  std::filesystem::rename(elsewhere, path_);
  damage();
  check(watch, start_ + kCheckAgainAfter + std::chrono::minutes(1));
  EXPECT_TRUE(watch.damage());
}

}  // namespace
}  // namespace hermite::server
