#include "server/client/sent_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client {
namespace {

using testing::HasSubstr;

// `count` frames "0", "1", ..., all of them sent.
SentFrames sent(int count) {
  SentFrames frames;
  for (int i = 0; i < count; ++i) {
    frames.add(std::to_string(i));
    frames.sent();
  }
  return frames;
}

TEST(SentFrames, AreSentOnceInOrder) {
  SentFrames frames;
  EXPECT_EQ(frames.next(), nullptr);
  frames.add("0");
  frames.add("1");
  EXPECT_EQ(frames.numbered_count(), 2u);
  EXPECT_EQ(*frames.next(), "0");
  frames.sent();
  EXPECT_EQ(*frames.next(), "1");
  frames.sent();
  EXPECT_EQ(frames.next(), nullptr);
  EXPECT_EQ(frames.sent_count(), 2u);
}

TEST(SentFrames, WhatIsDurableIsNotKept) {
  SentFrames frames = sent(5);
  EXPECT_EQ(frames.kept_count(), 5u);
  frames.durable(3);
  frames.durable(2);  // late: it changes nothing
  EXPECT_EQ(frames.first_kept(), 3u);
  EXPECT_EQ(frames.kept_count(), 2u);
  EXPECT_EQ(frames.numbered_count(), 5u);
  frames.add("5");
  frames.durable(100);  // a lie: frame 5 was never sent
  EXPECT_EQ(frames.kept_count(), 1u);
  EXPECT_EQ(*frames.next(), "5");
}

TEST(SentFrames, FromWhereTheServerGoesOnEverythingIsSentAgain) {
  SentFrames frames = sent(6);
  frames.durable(2);
  for (const std::uint64_t from : {6u, 2u, 4u}) {
    ASSERT_TRUE(frames.resume_at(from).ok());
    for (std::uint64_t i = from; i < 6; ++i) {
      ASSERT_NE(frames.next(), nullptr);
      EXPECT_EQ(*frames.next(), std::to_string(i));
      frames.sent();
    }
    EXPECT_EQ(frames.next(), nullptr);
  }
}

TEST(SentFrames, AServerThatWantsWhatIsNotThereIsAnError) {
  SentFrames frames = sent(6);
  frames.durable(2);
  for (const std::uint64_t from : {0u, 1u, 7u}) {
    const Status status = frames.resume_at(from);
    ASSERT_FALSE(status.ok());
    EXPECT_THAT(status.error().message, HasSubstr("frame " + std::to_string(from)));
  }
}

}  // namespace
}  // namespace hermite::client
