#include "server/capture/local_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/dataset/recording.h"
#include "core/log/frame_log_format.h"
#include "proto/wire/frame_payload.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client::local_log_test {
namespace {

using testing::HasSubstr;

const Camera kCamera{64, 64, 60, 60, 31.5, 31.5, 1000};
constexpr std::chrono::seconds kPatience(60);

frame::RgbdFrame frame_at(double time_s) {
  frame::RgbdFrame frame = wire::empty_frame(time_s, kCamera);
  for (std::size_t k = 0; k < frame.depth.pixels.size(); ++k)
    frame.depth.pixels[k] =
        static_cast<std::uint16_t>(1000 + k + static_cast<std::size_t>(time_s * 100));
  return frame;
}

std::unique_ptr<LocalLog> create(const std::string& folder) {
  auto log = LocalLog::create(folder, "a test", kCamera, wire::DepthCodec::kRanks);
  CHECK(log.ok(), log.ok() ? "" : log.error().message);
  return *std::move(log);
}

// So slowly that none is dropped.
void offer_one_by_one(LocalLog& log, int count, int first = 0) {
  for (int i = first; i < first + count; ++i) {
    log.offer(frame_at(i));
    log.wait_for(static_cast<std::uint64_t>(i) + 1, kPatience);
  }
}

std::vector<EncodedFrame> take_all(LocalLogFrames& frames, const WireEncoding& encoding) {
  std::vector<EncodedFrame> taken;
  EncodedFrame frame;
  for (int i = 0; i < 1000; ++i) {
    const Supply supply = frames.next(encoding, frame);
    if (supply == Supply::kEnd) break;
    if (supply == Supply::kFrame) taken.push_back(frame);
  }
  return taken;
}

TEST(LocalLog, IsReadFromItsBeginningWhileItGrows) {
  const test::TemporaryFolder folder;
  const auto log = create(folder / "log");
  LocalLogFrames frames(*log);
  EncodedFrame frame;
  EXPECT_EQ(frames.next({.depth = wire::DepthCodec::kRanks}, frame), Supply::kNotYet);
  for (int i = 0; i < 5; ++i) {
    offer_one_by_one(*log, 1, i);
    ASSERT_EQ(frames.next({.depth = wire::DepthCodec::kRanks}, frame), Supply::kFrame);
    EXPECT_EQ(frame.index, i);
    EXPECT_EQ(wire::decode_frame_payload(frame.frame, wire::DepthCodec::kRanks, kCamera)->depth,
              frame_at(i).depth);
  }
  log->finish();
  EXPECT_EQ(frames.next({.depth = wire::DepthCodec::kRanks}, frame), Supply::kEnd);
  EXPECT_EQ(log->state().durable_count, 5u);
  EXPECT_GT(log->state().bytes, 0u);
  LocalLogFrames again(*log);
  EXPECT_EQ(take_all(again, {.depth = wire::DepthCodec::kRanks}).size(), 5u);
}

TEST(LocalLog, AServerThatDoesNotKnowTheCodecGetsAnother) {
  const test::TemporaryFolder folder;
  const auto log = create(folder / "log");
  offer_one_by_one(*log, 2);
  log->finish();
  LocalLogFrames frames(*log);
  EXPECT_EQ(frames.depth_codecs().front(), wire::DepthCodec::kRanks);
  EXPECT_EQ(frames.depth_codecs().size(), wire::kDepthCodecs.size());
  const auto taken = take_all(frames, {.depth = wire::DepthCodec::kPng16});
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(wire::decode_frame_payload(taken[1].frame, wire::DepthCodec::kPng16, kCamera)->depth,
            frame_at(1).depth);
}

TEST(LocalLog, IsARecordingLikeAnyOther) {
  const test::TemporaryFolder folder;
  {
    const auto log = create(folder / "log");
    offer_one_by_one(*log, 3);
  }
  const auto recording = dataset::open_recording(folder / "log");
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->sequence->frame_count(), 3);
  EXPECT_EQ(recording->sequence->camera(), kCamera);
  EXPECT_EQ(recording->sequence->read(2)->depth, frame_at(2).depth);
  EXPECT_TRUE(recording->doubts.empty()) << recording->doubts.front();
}

TEST(LocalLog, MoreThanTheComputerCanEncodeIsDroppedAndCounted) {
  const test::TemporaryFolder folder;
  const auto log = create(folder / "log");
  constexpr int kOffered = 400;
  for (int i = 0; i < kOffered; ++i) log->offer(frame_at(i));
  log->finish();
  log->offer(frame_at(kOffered));
  const LocalLog::State state = log->state();
  EXPECT_TRUE(state.ended);
  EXPECT_EQ(state.durable_count + state.dropped_count, static_cast<std::uint64_t>(kOffered));
  EXPECT_GE(state.durable_count, LocalLog::kMaxWaiting);
}

TEST(LocalLog, AFolderThatIsThereIsLeftAlone) {
  const test::TemporaryFolder folder;
  const auto log = LocalLog::create(folder.path(), "a test", kCamera, wire::DepthCodec::kRanks);
  ASSERT_FALSE(log.ok());
  EXPECT_THAT(log.error().message, HasSubstr("is there already"));
}

TEST(LocalLog, ADiskThatDoesNotGiveBackWhatItTookEndsTheFramesWithAMessage) {
  const test::TemporaryFolder folder;
  const auto log = create(folder / "log");
  offer_one_by_one(*log, 4);
  log->finish();
  const std::string segment = folder / "log" + "/" + frame_log::segment_name(0);
  std::fstream file(segment, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-200, std::ios::end);  // in the last frame
  file.put('?');
  file.close();
  LocalLogFrames frames(*log);
  EXPECT_EQ(take_all(frames, {.depth = wire::DepthCodec::kRanks}).size(), 3u);
  ASSERT_TRUE(frames.failure());
  EXPECT_THAT(frames.failure()->message, HasSubstr("the checksum does not match"));
}

}  // namespace
}  // namespace hermite::client::local_log_test
