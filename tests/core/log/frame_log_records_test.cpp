#include "core/log/frame_log_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "core/log/frame_log.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hermite::frame_log {
namespace frame_log_records_test {

using testing::HasSubstr;

constexpr int kFrames = 23;

std::string payload(int index) { return "frame " + std::to_string(index); }

std::string bytes_of(const std::string& path) {
  const std::vector<std::uint8_t> bytes = test::file_bytes(path);
  return {bytes.begin(), bytes.end()};
}
void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

class FrameLogRecordsTest : public testing::Test {
 protected:
  // Two or three records a segment.
  FrameLogRecordsTest() {
    FrameLogOptions options;
    options.segment_bytes = 110;
    auto log = FrameLog::create(log_, "terms", "start", {[](std::uint64_t) {}, [](const Error&) {}},
                                options);
    EXPECT_TRUE(log.ok());
    for (int i = 0; i < kFrames; ++i)
      EXPECT_TRUE((*log)->append(RecordType::kFrame, payload(i)).ok());
    EXPECT_TRUE((*log)->append(RecordType::kFinish, "").ok());
  }
  std::string segment(std::uint32_t number) const { return log_ + "/" + segment_name(number); }
  // Flips a bit of a byte of a segment.
  void damage(std::uint32_t number, std::size_t byte) {
    std::string bytes = bytes_of(segment(number));
    bytes.at(byte) = static_cast<char>(bytes[byte] ^ 1);
    write(segment(number), bytes);
  }
  std::vector<std::uint64_t> visited() const {
    std::vector<std::uint64_t> numbers;
    EXPECT_TRUE(visit_log_records(log_, 5, [&](const LogRecordHead& head) {
                  numbers.push_back(head.number);
                }).ok());
    return numbers;
  }
  // Records that can be read.
  std::vector<std::uint64_t> readable() const {
    std::vector<std::uint64_t> numbers;
    for (std::uint64_t number = 0; number < kFrames + 3; ++number)
      if (read_log_record(log_, number).ok()) numbers.push_back(number);
    return numbers;
  }

  const test::TemporaryFolder folder_;
  const std::string log_ = folder_ / "log";
};

TEST_F(FrameLogRecordsTest, EachIsFoundByItsNumber) {
  ASSERT_TRUE(std::filesystem::exists(segment(7))) << "there are many segments";
  EXPECT_EQ(read_log_record(log_, 0)->payload, "terms");
  for (int i = kFrames - 1; i >= 0; --i) {
    const Result<LogRecord> record = read_log_record(log_, static_cast<std::uint64_t>(i) + 2);
    ASSERT_TRUE(record.ok()) << record.error().message;
    EXPECT_EQ(record->payload, payload(i));
    EXPECT_EQ(record->number, static_cast<std::uint64_t>(i) + 2);
  }
  EXPECT_EQ(read_log_record(log_, kFrames + 2)->type, RecordType::kFinish);
  for (const std::uint64_t number : {std::uint64_t{kFrames + 3}, ~std::uint64_t{0}})
    EXPECT_EQ(read_log_record(log_, number).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read_log_record(folder_ / "none", 0).error().code, ErrorCode::kNotFound);
}

TEST_F(FrameLogRecordsTest, AllAreShownWithTheirBeginnings) {
  std::vector<std::string> beginnings;
  const Status visited = visit_log_records(log_, 5, [&](const LogRecordHead& head) {
    beginnings.emplace_back(head.beginning);
    EXPECT_EQ(head.read()->number, head.number);
  });
  ASSERT_TRUE(visited.ok()) << visited.error().message;
  ASSERT_EQ(beginnings.size(), static_cast<std::size_t>(kFrames + 3));
  EXPECT_EQ(beginnings[0], "terms");
  EXPECT_EQ(beginnings[5], "frame");
  EXPECT_EQ(beginnings.back(), "");
  EXPECT_EQ(visit_log_records(folder_ / "none", 5, [](const LogRecordHead&) {}).error().code,
            ErrorCode::kNotFound);
}

TEST_F(FrameLogRecordsTest, DamageInAPayloadIsOfThatRecordAlone) {
  const std::vector<std::uint64_t> all = readable();
  damage(3, kSegmentHeaderBytes + kRecordHeaderBytes);
  const std::vector<std::uint64_t> left = readable();
  ASSERT_EQ(left.size(), all.size() - 1);
  EXPECT_EQ(visited(), all) << "payloads are not looked at";
  std::uint64_t damaged = 0;
  while (left[damaged] == damaged) ++damaged;
  const Result<LogRecord> record = read_log_record(log_, damaged);
  EXPECT_EQ(record.error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(record.error().message, "segment-000003.rlog at byte 16: the checksum is another one");
}

TEST_F(FrameLogRecordsTest, ADamagedHeadCostsTheRestOfItsSegmentAndNoOther) {
  const std::vector<std::uint64_t> all = readable();
  // The segment's, a record's.
  for (const std::size_t byte : {std::size_t{0}, kSegmentHeaderBytes}) {
    damage(4, byte);
    const std::vector<std::uint64_t> left = readable();
    EXPECT_GE(left.size(), all.size() - 3) << byte;
    EXPECT_LT(left.size(), all.size()) << byte;
    EXPECT_EQ(visited(), left) << byte;
    EXPECT_EQ(left.back(), all.back());
    std::uint64_t damaged = 0;
    while (left[damaged] == damaged) ++damaged;
    EXPECT_EQ(read_log_record(log_, damaged).error().code, ErrorCode::kCorruptData) << byte;
    EXPECT_THAT(read_log_record(log_, damaged).error().message,
                HasSubstr("segment-000004.rlog at byte"))
        << byte;
    damage(4, byte);
  }
  EXPECT_EQ(readable(), all);
}

TEST_F(FrameLogRecordsTest, ALogThatWasCutEndsThere) {
  const std::string bytes = bytes_of(segment(5));
  for (std::uint32_t number = 6; std::filesystem::exists(segment(number)); ++number)
    std::filesystem::remove(segment(number));
  write(segment(5), bytes.substr(0, kSegmentHeaderBytes));
  const std::vector<std::uint64_t> left = visited();
  EXPECT_EQ(read_log_record(log_, left.back()).ok(), true);
  EXPECT_EQ(read_log_record(log_, left.back() + 1).error().code, ErrorCode::kNotFound);
}

}  // namespace frame_log_records_test
}  // namespace hermite::frame_log
