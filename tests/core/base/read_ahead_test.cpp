#include "core/base/read_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

namespace hermite {
namespace {

TEST(ReadAhead, GivesEveryItemInOrder) {
  ReadAhead<std::int64_t> squares(3, 40, 2, [](std::int64_t index) { return index * index; });
  for (std::int64_t index = 3; index < 40; ++index) EXPECT_EQ(squares.next(), index * index);
  EXPECT_FALSE(squares.next());
  EXPECT_FALSE(squares.next());
}

TEST(ReadAhead, OfNothing) {
  ReadAhead<int> nothing(0, 0, 1, [](std::int64_t) { return 1; });
  EXPECT_FALSE(nothing.next());
}

TEST(ReadAhead, MakesNoMoreThanMayWait) {
  std::atomic<int> made = 0;
  ReadAhead<int> items(0, 100, 3, [&made](std::int64_t) { return ++made; });
  ASSERT_EQ(items.next(), 1);
  // Three wait; the thread has the time to make a fifth, and must not.
  while (made < 4) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(made, 4);
}

TEST(ReadAhead, MayBeLeftEarly) {
  std::atomic<int> made = 0;
  {
    ReadAhead<int> items(0, 1'000'000, 1, [&made](std::int64_t) { return ++made; });
    EXPECT_EQ(items.next(), 1);
  }
  EXPECT_LE(made, 3);
}

}  // namespace
}  // namespace hermite
