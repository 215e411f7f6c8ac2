// Frame logs as recordings, through the one importer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/dataset/recording.h"
#include "core/dataset/write_frame_log.h"
#include "core/log/frame_log.h"
#include "core/source/open_sequence.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/file_bytes.h"

namespace hermite::dataset::logged_frames_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kFrames = 4;
constexpr wire::DepthCodec kCodec = wire::DepthCodec::kRanks;

const Sequence& room() {
  static const std::unique_ptr<Sequence> sequence =
      *source::open_sequence("synthetic:frames=4,width=96,height=72");
  return *sequence;
}

std::string start_message() {
  wire::StartScan start{
      "a test", room().camera(), {kCodec}, {wire::ColorCodec::kPng}, wire::Mode::kBatch, {}, 0};
  return wire::format_client_message(wire::Hello{wire::kProtocolMinor, "", "", std::move(start)});
}

std::string frame_message(int index, double timestamp_s) {
  const RecordedFrame frame = *room().read(index);
  return wire::format_client_message(
      wire::Frame{static_cast<std::uint64_t>(index),
                  timestamp_s,
                  *wire::encode_depth_payload(frame.depth, kCodec),
                  {frame.color_bytes.begin(), frame.color_bytes.end()}});
}

std::string frame_message(int index) { return frame_message(index, room().timestamp_s(index)); }

struct Record {
  frame_log::RecordType type;
  std::string payload;
};

std::vector<Record> good_records() {
  std::vector<Record> records;
  for (int i = 0; i < kFrames; ++i)
    records.push_back({frame_log::RecordType::kFrame, frame_message(i)});
  records.push_back({frame_log::RecordType::kFinish, ""});
  return records;
}

void write_log(const std::string& folder, const std::vector<Record>& records,
               const std::string& start = start_message()) {
  frame_log::FrameLogOptions options;
  options.segment_bytes = 20'000;  // some segments
  const auto log = frame_log::FrameLog::create(
      folder, "{}", start, {[](std::uint64_t) {}, [](const Error&) {}}, options);
  CHECK(log.ok(), log.ok() ? "" : log.error().message);
  for (const Record& record : records)
    CHECK((*log)->append(record.type, record.payload).ok(), "the log takes records");
}

std::string refusal(const std::string& folder) {
  const auto recording = open_recording(folder);
  return recording.ok() ? "" : recording.error().message;
}

TEST(LoggedFrames, AreBitForBitWhatWasSent) {
  const TempFolder folder;
  write_log(folder.path("scan"), good_records());
  ASSERT_TRUE(fs::exists(folder.path("scan/segment-000001.rlog")));
  const auto recording = open_recording(folder.path("scan"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const Sequence& log = *recording->sequence;
  EXPECT_THAT(recording->doubts, IsEmpty());
  EXPECT_EQ(log.format(), "frame log");
  EXPECT_EQ(log.name(), "scan");
  EXPECT_EQ(log.camera(), room().camera());
  EXPECT_NEAR(log.frame_rate_hz(), room().frame_rate_hz(), 1e-6);
  ASSERT_EQ(log.frame_count(), kFrames);
  for (int i = kFrames - 1; i >= 0; --i) {
    const auto frame = log.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->timestamp_s, room().timestamp_s(i));
    EXPECT_EQ(frame->depth, room().read(i)->depth);
    EXPECT_EQ(frame->color_bytes, room().read(i)->color_bytes);
  }
}

TEST(LoggedFrames, AConvertedRecordingReadsBackTheSame) {
  const TempFolder folder;
  const auto source =
      *source::open_sequence("synthetic:frames=4,width=96,height=72+missing=1:1+accelerometer");
  const auto written = write_frame_log(*source, {0, source->frame_count()}, folder.path("scan"),
                                       [](std::int64_t) {});
  ASSERT_TRUE(written.ok()) << written.error().message;
  EXPECT_EQ(written->frame_count, source->frame_count());
  const auto recording = open_recording(folder.path("scan"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT(recording->doubts, IsEmpty());
  ASSERT_EQ(recording->sequence->frame_count(), source->frame_count());
  for (std::int64_t i = 0; i < source->frame_count(); ++i) {
    EXPECT_EQ(recording->sequence->timestamp_s(i), source->timestamp_s(i));
    EXPECT_EQ(recording->sequence->read(i)->depth, source->read(i)->depth);
    EXPECT_EQ(recording->sequence->read(i)->color_bytes, source->read(i)->color_bytes);
    EXPECT_EQ(recording->sequence->read(i)->acceleration_m_s2, source->read(i)->acceleration_m_s2);
  }
  EXPECT_TRUE(recording->sequence->read(0)->acceleration_m_s2.has_value());
  const auto again = write_frame_log(*source, {0, 1}, folder.path("scan"), [](std::int64_t) {});
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(again.error().message, HasSubstr("exists already"));
}

TEST(LoggedFrames, ABrokenOffLogIsReadUpToThereAndThatIsSaid) {
  const TempFolder folder;
  auto records = good_records();
  records.pop_back();
  write_log(folder.path("scan"), records);
  EXPECT_THAT(open_recording(folder.path("scan"))->doubts,
              testing::ElementsAre(HasSubstr("not finished")));
  const std::string last = folder.path("scan/segment-000000.rlog");
  const auto whole = test::file_bytes(last).size();
  fs::resize_file(last, whole - 1);
  const auto cut = open_recording(folder.path("scan"));
  ASSERT_TRUE(cut.ok()) << cut.error().message;
  EXPECT_LT(cut->sequence->frame_count(), kFrames);
  EXPECT_THAT(cut->doubts, testing::Contains(HasSubstr("the log is cut")));
}

TEST(LoggedFrames, CutAnywhereItIsRefusedOrReadUpToThere) {
  const TempFolder folder;
  write_log(folder.path("scan"), good_records());
  const std::string first = folder.path("scan/segment-000000.rlog");
  const auto whole = test::file_bytes(first).size();
  for (std::size_t k = 0; k < 20; ++k) {
    fs::resize_file(first, whole * (20 - k) / 20 - 1);
    const auto recording = open_recording(folder.path("scan"));
    if (!recording.ok()) continue;
    for (std::int64_t i = 0; i < recording->sequence->frame_count(); ++i)
      EXPECT_TRUE(recording->sequence->read(i).ok());
    EXPECT_THAT(recording->doubts, testing::Contains(HasSubstr("cut")));
  }
  EXPECT_NE(refusal(folder.path("scan")), "");
}

TEST(LoggedFrames, FramesThatTheScanRefusedAreNotThere) {
  const TempFolder folder;
  auto records = good_records();
  records.insert(records.begin() + 1, {frame_log::RecordType::kRefusedFrame, ""});
  records.insert(records.begin() + 3,
                 {frame_log::RecordType::kFrame, frame_message(0, room().timestamp_s(1))});
  records.insert(records.begin() + 4,
                 {frame_log::RecordType::kFrame, frame_message(0, std::nan(""))});
  write_log(folder.path("scan"), records);
  const auto recording = open_recording(folder.path("scan"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->sequence->frame_count(), kFrames);
  EXPECT_THAT(recording->doubts,
              testing::Contains(HasSubstr("2 frames have no time after the one before")));
}

TEST(LoggedFrames, ADamagedImageIsThatFramesErrorAlone) {
  const TempFolder folder;
  auto records = good_records();
  records[1].payload =
      wire::format_client_message(wire::Frame{1, room().timestamp_s(1), "no depth", "no colour"});
  write_log(folder.path("scan"), records);
  const auto recording = open_recording(folder.path("scan"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_FALSE(recording->sequence->read(1).ok());
  EXPECT_TRUE(recording->sequence->read(2).ok());
}

TEST(LoggedFrames, WhatIsNoLogOfACameraIsRefusedWithAMessage) {
  const TempFolder folder;
  write_log(folder.path("empty"), {});
  EXPECT_THAT(refusal(folder.path("empty")), HasSubstr("the log has no frame"));
  write_log(folder.path("viewer"), good_records(),
            wire::format_client_message(wire::Hello{2, "", "", wire::ViewScan{"4f"}}));
  EXPECT_THAT(refusal(folder.path("viewer")), HasSubstr("no hello of a camera"));
  write_log(folder.path("garbage"), good_records(), "\xff\xff");
  EXPECT_THAT(refusal(folder.path("garbage")), HasSubstr("record 1"));
  auto records = good_records();
  records[2].payload = wire::format_client_message(wire::Finish{});
  write_log(folder.path("other"), records);
  EXPECT_THAT(refusal(folder.path("other")), HasSubstr("another message than a frame"));
  write_log(folder.path("scan"), good_records());
  const auto other_size =
      open_recording(folder.path("scan"), Camera{128, 96, 100, 100, 64, 48, 1000});
  ASSERT_FALSE(other_size.ok());
  EXPECT_THAT(other_size.error().message, HasSubstr("96x72"));
}

}  // namespace
}  // namespace hermite::dataset::logged_frames_test
