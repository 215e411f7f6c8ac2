#include "server/disk/pending_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace hermite::server {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

struct Named {
  std::string id;
  int value = 0;
};

// A store that takes changes or not, of all rows or of single ones, and of all that it was asked
// for.
class PendingChangesTest : public testing::Test {
 protected:
  using Changes = PendingChanges<Named>;
  void tick(std::chrono::steady_clock::duration later) { changes_.tick(now_ += later); }
  void settle() {
    tick(milliseconds(0));
    tick(kChangeAgainAfter);
  }

  bool has_room_ = true;
  std::set<std::string> refused_, unknown_;
  std::map<std::string, int> stored_;
  std::vector<std::string> asked_;
  Changes changes_{"scan", "that it has ended", [this](const Named& row) -> Status {
                     asked_.push_back(row.id);
                     if (unknown_.contains(row.id))
                       return Error{ErrorCode::kNotFound, "there is no scan " + row.id};
                     if (!has_room_ || refused_.contains(row.id))
                       return Error{ErrorCode::kIo, "database or disk is full"};
                     stored_[row.id] = row.value;
                     return Done{};
                   }};
  Changes::Clock::time_point now_;
};

TEST_F(PendingChangesTest, WhatTheStoreTakesIsNotKept) {
  EXPECT_TRUE(changes_.make({"a", 1}).ok());
  EXPECT_EQ(stored_.at("a"), 1);
  EXPECT_TRUE(changes_.empty());
  EXPECT_EQ(changes_.find("a"), nullptr);
}

TEST_F(PendingChangesTest, WhatItCannotTakeIsShownAndTriedAgainAfterAPause) {
  has_room_ = false;
  EXPECT_EQ(changes_.make({"a", 1}).error().code, ErrorCode::kIo);
  ASSERT_NE(changes_.find("a"), nullptr);
  EXPECT_EQ(changes_.find("a")->value, 1);
  tick(milliseconds(0));
  tick(kChangeAgainAfter - milliseconds(1));
  EXPECT_EQ(asked_.size(), 1u) << "each attempt may take as long as the disk does";
  tick(milliseconds(1));
  EXPECT_EQ(asked_.size(), 2u);
  has_room_ = true;
  tick(kChangeAgainAfter - milliseconds(1));
  EXPECT_FALSE(stored_.contains("a"));
  tick(milliseconds(1));
  EXPECT_EQ(stored_.at("a"), 1);
  EXPECT_TRUE(changes_.empty());
  settle();
  EXPECT_EQ(asked_.size(), 3u) << "once stored it is not asked for again";
}

TEST_F(PendingChangesTest, TheNewestChangeOfARowCounts) {
  has_room_ = false;
  (void)changes_.make({"a", 1});
  (void)changes_.make({"a", 2});
  EXPECT_EQ(changes_.find("a")->value, 2);
  changes_.find("a")->value = 3;
  has_room_ = true;
  settle();
  EXPECT_EQ(stored_.at("a"), 3);
}

TEST_F(PendingChangesTest, ANewerChangeThatIsTakenIsNotOverwritten) {
  has_room_ = false;
  (void)changes_.make({"a", 1});
  (void)changes_.make({"b", 1});
  has_room_ = true;
  EXPECT_TRUE(changes_.make({"a", 2}).ok());
  changes_.forget("b");
  settle();
  EXPECT_THAT(stored_, ElementsAre(std::pair("a", 2)));
}

TEST_F(PendingChangesTest, AfterOneFailureTheOthersAreNotTriedButNotKeptByItEither) {
  has_room_ = false;
  for (const char* id : {"a", "b", "c"}) (void)changes_.make({id, 1});
  asked_.clear();
  settle();
  EXPECT_THAT(asked_, ElementsAre("a")) << "the store would fail as long for each";
  has_room_ = true;
  refused_ = {"b"};
  tick(kChangeAgainAfter);
  EXPECT_TRUE(stored_.empty()) << "b was the next, and failed";
  tick(kChangeAgainAfter);
  EXPECT_THAT(stored_, ElementsAre(std::pair("a", 1), std::pair("c", 1)));
  EXPECT_NE(changes_.find("b"), nullptr);
}

TEST_F(PendingChangesTest, ARowThatIsGoneIsNotTriedAgain) {
  unknown_ = {"a"};
  EXPECT_EQ(changes_.make({"a", 1}).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(changes_.empty());
  has_room_ = false;
  (void)changes_.make({"b", 1});
  unknown_ = {"b"};
  settle();
  EXPECT_TRUE(changes_.empty());
}

TEST_F(PendingChangesTest, SaysWhenNothingNewShouldBegin) {
  has_room_ = false;
  for (std::size_t i = 0; i < kMaxPendingChanges; ++i) {
    EXPECT_FALSE(changes_.full());
    (void)changes_.make({std::to_string(i), 1});
  }
  EXPECT_TRUE(changes_.full());
  has_room_ = true;
  settle();
  EXPECT_FALSE(changes_.full());
  EXPECT_EQ(stored_.size(), kMaxPendingChanges);
}

}  // namespace
}  // namespace hermite::server
