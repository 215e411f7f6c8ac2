#include "server/disk/storage_quota.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

namespace hermite::server {
namespace {

using testing::HasSubstr;

// Both threads are queues that the test empties as it likes.
class StorageQuotaTest : public testing::Test {
 protected:
  StorageQuota make(std::uint64_t limit_bytes) {
    return {limit_bytes,
            [this] {
              ++measured_count_;
              return sizes_;
            },
            {[this](std::function<void()> action) { network_.push_back(std::move(action)); },
             [this](std::function<void()> action) { background_.push_back(std::move(action)); }}};
  }
  static void run(std::vector<std::function<void()>>& queue) {
    for (const std::function<void()>& action : std::exchange(queue, {})) action();
  }
  static StorageQuota::Clock::time_point in(std::chrono::seconds wait) {
    return StorageQuota::Clock::now() + wait;
  }

  std::vector<std::function<void()>> network_, background_;
  Result<StorageQuota::Sizes> sizes_ = StorageQuota::Sizes{{"a", 60'000'000}, {"b", 30'000'000}};
  int measured_count_ = 0;
};

TEST_F(StorageQuotaTest, ScansUploadsAndWhatIsToComeMayTakeSoMuch) {
  const StorageQuota quota = make(100'000'000);
  EXPECT_TRUE(quota.check(0, 10'000'000).ok());
  EXPECT_TRUE(quota.check(4'000'000, 6'000'000).ok());
  const Status beyond = quota.check(4'000'000, 6'000'001);
  ASSERT_FALSE(beyond.ok());
  EXPECT_EQ(beyond.error().code, ErrorCode::kBusy);
  EXPECT_THAT(
      beyond.error().message,
      HasSubstr(
          "the scans and uploads on this server take 94 MB of the 100 MB that they may take"));
}

TEST_F(StorageQuotaTest, WithoutALimitNobodyLooks) {
  StorageQuota quota = make(0);
  EXPECT_TRUE(quota.check(std::uint64_t{1} << 60, std::uint64_t{1} << 60).ok());
  quota.files_changed();
  quota.tick(in(std::chrono::hours(1)));
  EXPECT_TRUE(background_.empty());
  EXPECT_EQ(measured_count_, 0);
}

TEST_F(StorageQuotaTest, LooksNowAndThenAndNeverOnTheNetworkThread) {
  StorageQuota quota = make(100'000'000);
  sizes_->emplace("c", 10'000'000);
  quota.tick(in(std::chrono::seconds(1)));
  EXPECT_TRUE(background_.empty()) << "too early";
  quota.tick(in(std::chrono::seconds(6)));
  quota.tick(in(std::chrono::seconds(12)));
  EXPECT_EQ(measured_count_, 1) << "only at the start";
  ASSERT_EQ(background_.size(), 1u) << "one look at a time";
  run(background_);
  EXPECT_TRUE(quota.check(0, 1).ok()) << "not told yet";
  run(network_);
  EXPECT_FALSE(quota.check(0, 1).ok());
}

TEST_F(StorageQuotaTest, AScanThatHasEndedCountsSoonEvenIfItEndsDuringALook) {
  StorageQuota quota = make(100'000'000);
  quota.files_changed();
  run(background_);  // it had not written its results yet
  sizes_->emplace("c", 10'000'000);
  quota.files_changed();
  run(network_);
  EXPECT_TRUE(quota.check(0, 1).ok());
  run(background_);
  run(network_);
  EXPECT_FALSE(quota.check(0, 1).ok());
  EXPECT_TRUE(background_.empty());
}

TEST_F(StorageQuotaTest, WhatWasRemovedMakesRoomAtOnceAlsoDuringALook) {
  StorageQuota quota = make(100'000'000);
  quota.tick(in(std::chrono::seconds(6)));
  run(background_);  // it still saw it
  quota.removed("a");
  EXPECT_TRUE(quota.check(0, 70'000'000).ok());
  run(network_);
  EXPECT_TRUE(quota.check(0, 70'000'000).ok());
  EXPECT_FALSE(quota.check(0, 70'000'001).ok());
}

TEST_F(StorageQuotaTest, WithoutKnowingWhatThereIsNothingBegins) {
  sizes_ = Error{ErrorCode::kIo, "the disk is gone"};
  StorageQuota quota = make(100'000'000);
  EXPECT_EQ(quota.check(0, 1).error().message, "the disk is gone");
  sizes_ = StorageQuota::Sizes();
  quota.tick(in(std::chrono::seconds(6)));
  run(background_);
  run(network_);
  EXPECT_TRUE(quota.check(0, 1).ok()) << "it is back";
}

}  // namespace
}  // namespace hermite::server
