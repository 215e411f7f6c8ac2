#include "server/scan/received_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hermite::server::received_frames_test {
namespace {

using testing::HasSubstr;

ReceivedFrames fresh(std::uint32_t credit_window = 2) { return {credit_window, 0, {}}; }

// An earlier server has received so many, and all of them are on disk.
ReceivedFrames continued(std::uint64_t received, std::uint64_t refused = 0) {
  return {2, 0, {received, refused, 10.0, false}};
}

TEST(ReceivedFrames, AreNumberedWithoutGaps) {
  ReceivedFrames frames = fresh();
  EXPECT_THAT(frames.receive(1).error().message, HasSubstr("frame.sequence is 1, expected is 0"));
  EXPECT_TRUE(frames.receive(0).ok());
  EXPECT_EQ(frames.receive(0).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(frames.counts().received, 1u) << "a wrong one does not count";
}

TEST(ReceivedFrames, NeedCreditThatComesBackWhenTheyAreHandledAndOnDisk) {
  ReceivedFrames frames = fresh(2);
  EXPECT_TRUE(frames.receive(0).ok());
  EXPECT_TRUE(frames.receive(1).ok());
  EXPECT_FALSE(frames.camera_may_send());
  EXPECT_THAT(frames.receive(2).error().message,
              HasSubstr("came without credit: granted are 2 frames in all"));
  frames.processed();
  EXPECT_EQ(frames.credit().frames_granted, 2u) << "it is not on disk";
  EXPECT_EQ(frames.free_window(), 1u);
  frames.durable(2);
  EXPECT_EQ(frames.credit().frames_granted, 3u);
  EXPECT_EQ(frames.credit().durable_frames, 2u);
  EXPECT_TRUE(frames.receive(2).ok());
  frames.dropped();
  EXPECT_EQ(frames.granted(), 4u) << "a dropped frame is handled, too";
}

TEST(ReceivedFrames, AreCountedAsDroppedWithoutAUsableTimestamp) {
  ReceivedFrames frames = fresh();
  EXPECT_TRUE(frames.take_timestamp(5).ok());
  EXPECT_THAT(frames.take_timestamp(5).error().message,
              HasSubstr("not after 5.000000 of the frame before"));
  for (const double unusable :
       {std::nan(""), std::numeric_limits<double>::infinity(), 2 * kMaxTimestamp_s})
    EXPECT_THAT(frames.take_timestamp(unusable).error().message, HasSubstr("not a finite number"));
  EXPECT_EQ(frames.counts().dropped, 4u);
  EXPECT_TRUE(frames.take_timestamp(5.1).ok()) << "it is compared with the last usable one";
}

TEST(ReceivedFrames, GoOnWhereAnEarlierServerEnded) {
  ReceivedFrames frames = continued(7, 1);
  EXPECT_EQ(frames.counts().received, 7u);
  EXPECT_EQ(frames.counts().dropped, 1u);
  EXPECT_EQ(frames.durable_count(), 7u);
  EXPECT_FALSE(frames.camera_may_send()) << "the others are still to be processed again";
  frames.restored(5, 1);
  EXPECT_EQ(frames.granted(), 9u);
  EXPECT_TRUE(frames.receive(7).ok());
  EXPECT_FALSE(frames.take_timestamp(10).ok());
}

TEST(ReceivedFrames, OfAScanAreNotTooMany) {
  ReceivedFrames frames = continued(kMaxFramesPerScan);
  frames.restored(kMaxFramesPerScan, 0);
  EXPECT_EQ(frames.receive(kMaxFramesPerScan).error().code, ErrorCode::kTooLarge);
}

TEST(ReceivedFrames, RemainWhileFewerThanExpectedAreHandled) {
  EXPECT_FALSE(fresh().remaining_count()) << "nobody has said how many come";
  ReceivedFrames frames(16, 2, {});
  EXPECT_EQ(frames.remaining_count(), 2u);
  frames.processed();
  EXPECT_EQ(frames.remaining_count(), 1u);
  frames.dropped();
  frames.dropped();
  EXPECT_EQ(frames.remaining_count(), 0u);
}

}  // namespace
}  // namespace hermite::server::received_frames_test
