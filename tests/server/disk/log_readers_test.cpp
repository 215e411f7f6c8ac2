#include "server/disk/log_readers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hermite::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Both threads are queues that the test empties as it likes. No log is ever good here: what becomes
// of it is not the readers' business.
class LogReadersTest : public testing::Test {
 protected:
  void read(const std::string& id) {
    readers_.read(
        id,
        [this, id]() -> LogReaders::Opened {
          opened_.push_back(id);
          return Error{ErrorCode::kNotFound, id};
        },
        [this](const LogReaders::Opened& opened) { told_.push_back(opened.error().message); });
  }
  void wait_for(const std::string& id) {
    tickets_.push_back(readers_.when_read(id, [this, id] { woken_.push_back(id); }));
  }
  static void run(std::vector<std::function<void()>>& queue) {
    for (const std::function<void()>& action : std::exchange(queue, {})) action();
  }
  void settle() {
    while (!background_.empty() || !network_.empty()) {
      run(background_);
      run(network_);
    }
  }

  std::vector<std::function<void()>> network_, background_;
  std::vector<std::string> opened_, told_, woken_;
  std::vector<LogReaders::Ticket> tickets_;
  std::size_t room_ = 10;
  LogReaders readers_{
      {[this](std::function<void()> action) { network_.push_back(std::move(action)); },
       [this](std::function<void()> action) { background_.push_back(std::move(action)); }},
      [this](std::size_t reading_count) { return reading_count < room_; }};
};

TEST_F(LogReadersTest, ReadsFirstWhatCameFirstAndFewAtOnce) {
  for (const char* id : {"a", "b", "c", "d"}) read(id);
  EXPECT_EQ(readers_.reading_count(), kMaxLogsRead);
  EXPECT_TRUE(readers_.is_waited_for("d"));
  run(background_);
  EXPECT_THAT(opened_, ElementsAre("a", "b"));
  EXPECT_THAT(told_, IsEmpty()) << "told on the network thread only";
  settle();
  EXPECT_THAT(told_, ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(readers_.reading_count(), 0u);
  EXPECT_FALSE(readers_.is_waited_for("a"));
}

TEST_F(LogReadersTest, ReadsNoMoreThanThereIsRoomFor) {
  room_ = 0;
  read("a");
  settle();
  EXPECT_THAT(opened_, IsEmpty());
  room_ = 1;
  readers_.go_on();
  settle();
  EXPECT_THAT(told_, ElementsAre("a"));
}

TEST_F(LogReadersTest, WhoWaitsIsWokenOnceWhenItWasRead) {
  read("a");
  read("b");
  wait_for("a");
  EXPECT_THAT(woken_, IsEmpty());
  settle();
  EXPECT_THAT(woken_, ElementsAre("a"));
  readers_.tick(LogReaders::Clock::now() + 2 * kReadPatience);
  EXPECT_THAT(woken_, ElementsAre("a"));
}

TEST_F(LogReadersTest, WhoHasWaitedLongEnoughIsWokenBefore) {
  read("a");
  wait_for("a");
  readers_.tick(LogReaders::Clock::now());
  EXPECT_THAT(woken_, IsEmpty());
  readers_.tick(LogReaders::Clock::now() + 2 * kReadPatience);
  EXPECT_THAT(woken_, ElementsAre("a"));
  EXPECT_TRUE(readers_.is_waited_for("a"));
}

TEST_F(LogReadersTest, WhoHasGoneIsNotWoken) {
  read("a");
  wait_for("a");
  readers_.forget(tickets_.front());
  settle();
  EXPECT_THAT(woken_, IsEmpty());
}

TEST_F(LogReadersTest, WhatIsDroppedIsToldToNobody) {
  read("a");
  run(background_);
  wait_for("a");
  readers_.drop("a");
  EXPECT_THAT(woken_, ElementsAre("a")) << "to hear that there is nothing any more";
  read("a");  // anew, while the first one is still on its way
  settle();
  EXPECT_THAT(told_, ElementsAre("a"));
  EXPECT_EQ(readers_.reading_count(), 0u);
}

TEST_F(LogReadersTest, AtTheEndNothingIsBegunAndNothingIsTold) {
  for (const char* id : {"a", "b", "c"}) read(id);
  wait_for("c");
  readers_.stop();
  EXPECT_THAT(woken_, ElementsAre("c"));
  EXPECT_EQ(readers_.reading_count(), 2u) << "these come to their end";
  settle();
  EXPECT_THAT(opened_, ElementsAre("a", "b"));
  EXPECT_THAT(told_, IsEmpty());
  EXPECT_EQ(readers_.reading_count(), 0u);
}

}  // namespace
}  // namespace hermite::server
