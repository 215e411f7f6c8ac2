#include "server/scan/frame_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace hermite::server {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kNoTime(0), kLong(10'000);

wire::Frame frame(std::uint64_t sequence) { return {sequence, 0, "", ""}; }

TEST(FrameQueue, GivesFramesInOrder) {
  FrameQueue queue(4);
  for (std::uint64_t i = 0; i < 4; ++i) EXPECT_FALSE(queue.push(frame(i)));
  for (std::uint64_t i = 0; i < 4; ++i) EXPECT_EQ(queue.pop(kNoTime).frame->sequence, i);
}

TEST(FrameQueue, TheOldestMakesRoom) {
  FrameQueue queue(2);
  EXPECT_FALSE(queue.push(frame(0)));
  EXPECT_FALSE(queue.push(frame(1)));
  EXPECT_EQ(queue.push(frame(2))->sequence, 0u);
  EXPECT_EQ(queue.pop(kNoTime).frame->sequence, 1u);
  EXPECT_EQ(queue.pop(kNoTime).frame->sequence, 2u);
}

TEST(FrameQueue, AnEmptyOneIsNotAClosedOne) {
  FrameQueue queue(2);
  const FrameQueue::Popped popped = queue.pop(milliseconds(1));
  EXPECT_FALSE(popped.frame);
  EXPECT_FALSE(popped.closed);
}

TEST(FrameQueue, WhatWaitsIsStillGivenAfterClosing) {
  FrameQueue queue(2);
  queue.push(frame(0));
  queue.close(false);
  EXPECT_EQ(queue.push(frame(1))->sequence, 1u) << "nothing gets in any more";
  EXPECT_EQ(queue.pop(kNoTime).frame->sequence, 0u);
  EXPECT_TRUE(queue.pop(kNoTime).closed);
}

TEST(FrameQueue, ClosingMayDiscard) {
  FrameQueue queue(2);
  queue.push(frame(0));
  queue.close(false);
  queue.close(true);
  EXPECT_TRUE(queue.pop(kNoTime).closed);
}

TEST(FrameQueue, AWaitEndsWithAFrameAndWithTheEnd) {
  FrameQueue queue(2);
  std::thread other([&queue] {
    std::this_thread::sleep_for(milliseconds(20));
    queue.push(frame(5));
  });
  EXPECT_EQ(queue.pop(kLong).frame->sequence, 5u);
  other.join();
  std::thread closing([&queue] {
    std::this_thread::sleep_for(milliseconds(20));
    queue.close(false);
  });
  EXPECT_TRUE(queue.pop(kLong).closed);
  closing.join();
}

TEST(FrameQueue, NothingIsLostBetweenTwoThreads) {
  FrameQueue queue(100'000);
  std::thread writer([&queue] {
    for (std::uint64_t i = 0; i < 50'000; ++i) queue.push(frame(i));
    queue.close(false);
  });
  std::uint64_t expected = 0;
  for (;;) {
    const FrameQueue::Popped popped = queue.pop(kLong);
    if (popped.closed) break;
    ASSERT_TRUE(popped.frame);
    ASSERT_EQ(popped.frame->sequence, expected++);
  }
  writer.join();
  EXPECT_EQ(expected, 50'000u);
}

TEST(FrameQueue, KnowsTheWeightOfWhatWaits) {
  FrameQueue queue(2);
  const auto frame = [](std::size_t bytes) {
    return wire::Frame{0, 0, std::string(bytes, 'd'), std::string(1, 'c')};
  };
  EXPECT_EQ(queue.waiting_bytes(), 0u);
  queue.push(frame(10));
  queue.push(frame(20));
  EXPECT_EQ(queue.waiting_bytes(), 32u);
  queue.push(frame(100));  // the oldest makes room
  EXPECT_EQ(queue.waiting_bytes(), 122u);
  const auto before = std::chrono::steady_clock::now();
  const FrameQueue::Popped popped = queue.pop(std::chrono::milliseconds(0));
  EXPECT_EQ(queue.waiting_bytes(), 101u);
  EXPECT_LE(popped.since, before);
  queue.close(true);
  EXPECT_EQ(queue.waiting_bytes(), 0u);
}

}  // namespace
}  // namespace hermite::server
