#include "core/log/frame_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>

#include "tests/support/temporary_folder.h"

namespace hermite::frame_log {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// What a log tells, to be waited for.
class Told {
 public:
  FrameLogEvents events() {
    return {[this](std::uint64_t count) { change([&] { durable_ = count, ++durable_calls_; }); },
            [this](const Error& error) { change([&] { failure_ = error.message; }); }};
  }
  bool wait_for_durable(std::uint64_t count) {
    return wait([&] { return durable_ >= count; });
  }
  bool wait_for_failure() {
    return wait([&] { return !failure_.empty(); });
  }
  std::uint64_t durable() {
    const std::lock_guard lock(mutex_);
    return durable_;
  }
  int durable_calls() {
    const std::lock_guard lock(mutex_);
    return durable_calls_;
  }
  std::string failure() {
    const std::lock_guard lock(mutex_);
    return failure_;
  }

 private:
  template <class Change>
  void change(Change change) {
    const std::lock_guard lock(mutex_);
    change();
    changed_.notify_all();
  }
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), condition);
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t durable_ = 0;
  int durable_calls_ = 0;
  std::string failure_;
};

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

std::vector<LogRecord> records_of(const std::string& folder) {
  std::vector<LogRecord> records;
  FrameLogReader reader(folder);
  for (;;) {
    Result<std::optional<LogRecord>> record = reader.next();
    EXPECT_TRUE(record.ok()) << record.error().message;
    if (!record.ok() || !*record) return records;
    records.push_back(**std::move(record));
  }
}

std::string payload(int index) {
  return "frame " + std::to_string(index) +
         std::string(static_cast<std::size_t>(index % 5), '\xff');
}

constexpr int kFrames = 9;

class FrameLogTest : public testing::Test {
 protected:
  // Two or three records a segment.
  static FrameLogOptions small_segments() {
    FrameLogOptions options;
    options.segment_bytes = 110;
    return options;
  }
  // terms, start, kFrames frames of which number 4 is a refused one, finish.
  void write_log() {
    auto log = FrameLog::create(log_, "terms", "start", told_.events(), small_segments());
    ASSERT_TRUE(log.ok()) << log.error().message;
    for (int i = 0; i < kFrames; ++i)
      ASSERT_TRUE((*log)
                      ->append(i == 4 ? RecordType::kRefusedFrame : RecordType::kFrame,
                               i == 4 ? "" : payload(i))
                      .ok());
    ASSERT_TRUE((*log)->append(RecordType::kFinish, "").ok());
  }
  // The files of the log, in order.
  std::vector<std::string> segments() const {
    std::vector<std::string> paths;
    for (const auto& entry : fs::directory_iterator(log_)) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
  }
  // Opens what is on disk, which must be the first records of `whole` and no more than `most`; adds
  // a frame, and finds it behind them.
  void expect_a_good_beginning(const std::vector<LogRecord>& whole, std::size_t most,
                               const std::string& what) {
    Result<FrameLog::Opened> opened = FrameLog::open(log_, told_.events(), small_segments());
    if (most < 2) {
      ASSERT_FALSE(opened.ok()) << what;
      EXPECT_FALSE(opened.error().message.empty());
      return;
    }
    ASSERT_TRUE(opened.ok()) << what << ": " << opened.error().message;
    const std::uint64_t count = opened->contents.record_count;
    ASSERT_EQ(count, most) << what;
    ASSERT_TRUE(opened->log->append(RecordType::kFrame, "added").ok());
    opened->log.reset();
    const std::vector<LogRecord> records = records_of(log_);
    ASSERT_EQ(records.size(), count + 1) << what;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(records[i].type, whole[i].type) << what;
      EXPECT_EQ(records[i].payload, whole[i].payload) << what;
    }
    EXPECT_EQ(records.back().payload, "added") << what;
  }

  const test::TemporaryFolder folder_;
  const std::string log_ = folder_ / "scan-log";
  Told told_;
};

TEST_F(FrameLogTest, IsReadWhileItGrowsAsFarAsItIsDurable) {
  auto log = FrameLog::create(log_, "terms", "start", told_.events(), small_segments());
  ASSERT_TRUE(log.ok()) << log.error().message;
  FrameLogReader reader(log_);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(*reader.next());
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE((*log)->append(RecordType::kFrame, payload(i)).ok());
    ASSERT_TRUE(told_.wait_for_durable(static_cast<std::uint64_t>(i) + 1));
    const Result<std::optional<LogRecord>> record = reader.next();
    ASSERT_TRUE(record.ok()) << record.error().message;
    ASSERT_TRUE(*record) << "record " << i << ": " << reader.end().message;
    EXPECT_EQ((*record)->payload, payload(i));
  }
  EXPECT_GT(segments().size(), 2u);
}

TEST_F(FrameLogTest, ALogInTheWorkingFolderMayBeNamedWithoutAPath) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  for (const char* name : {"bare", "with-slash/"})
    EXPECT_TRUE(FrameLog::create(name, "terms", "start", told_.events()).ok()) << name;
  fs::current_path(before);
  EXPECT_EQ(records_of(folder_ / "bare").size(), 2u);
  EXPECT_EQ(records_of(folder_ / "with-slash").size(), 2u);
}

TEST(Crc32c, IsThatOfTheStandard) {
  EXPECT_EQ(crc32c("123456789"), 0xe3069283u);
  EXPECT_EQ(crc32c(std::string(32, '\0')), 0x8a9136aau) << "RFC 3720, B.4";
  EXPECT_EQ(crc32c("6789", crc32c("12345")), crc32c("123456789"));
}

TEST_F(FrameLogTest, ComesBackAsItWasWritten) {
  write_log();
  EXPECT_EQ(told_.durable(), static_cast<std::uint64_t>(kFrames)) << "the destructor syncs";
  EXPECT_GE(segments().size(), 4u);
  const std::vector<LogRecord> records = records_of(log_);
  ASSERT_EQ(records.size(), static_cast<std::size_t>(kFrames + 3));
  EXPECT_EQ(records[0].payload, "terms");
  EXPECT_EQ(records[1].payload, "start");
  for (int i = 0; i < kFrames; ++i)
    EXPECT_EQ(records[static_cast<std::size_t>(i + 2)].payload, i == 4 ? "" : payload(i));
  const auto opened = FrameLog::open(log_, told_.events());
  ASSERT_TRUE(opened.ok());
  EXPECT_EQ(opened->contents.terms, "terms");
  EXPECT_EQ(opened->contents.start, "start");
  EXPECT_EQ(opened->contents.record_count, static_cast<std::uint64_t>(kFrames + 3));
  EXPECT_EQ(opened->contents.frame_count, static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(opened->contents.refused_count, 1u);
  EXPECT_EQ(opened->contents.last_frame, payload(kFrames - 1));
  EXPECT_TRUE(opened->contents.finished);
  EXPECT_EQ(opened->contents.cut, "");
}

TEST_F(FrameLogTest, CutAnywhereItIsTheWholeRecordsBefore) {
  write_log();
  const std::vector<LogRecord> whole = records_of(log_);
  const std::vector<std::string> paths = segments();
  std::vector<std::string> contents;
  for (const std::string& path : paths) contents.push_back(bytes_of(path));
  for (std::size_t segment = 0; segment < paths.size(); ++segment) {
    for (std::size_t length = 0; length < contents[segment].size(); ++length) {
      fs::remove_all(log_);
      fs::create_directory(log_);
      // A cut log has later segments only after a disk has lied; they must go then.
      for (std::size_t i = 0; i < paths.size(); ++i)
        write_bytes(paths[i], contents[i].substr(0, i == segment ? length : std::string::npos));
      const std::vector<LogRecord> left = records_of(log_);
      expect_a_good_beginning(
          whole, left.size(),
          "segment " + std::to_string(segment) + " cut to " + std::to_string(length));
      ASSERT_LT(left.size(), whole.size());
      // All records that end before the cut, and none more.
      std::size_t end = kSegmentHeaderBytes, expected = 0;
      for (std::size_t i = 0; i < segment; ++i)
        for (std::size_t at = kSegmentHeaderBytes; at < contents[i].size(); ++expected)
          at += kRecordHeaderBytes +
                parse_record_header(contents[i].substr(at, kRecordHeaderBytes))->length;
      while (end + kRecordHeaderBytes <= length) {
        end += kRecordHeaderBytes +
               parse_record_header(contents[segment].substr(end, kRecordHeaderBytes))->length;
        if (end <= length) ++expected;
      }
      ASSERT_EQ(left.size(), expected);
    }
  }
}

TEST_F(FrameLogTest, AFlippedBitEndsItBeforeThatRecord) {
  write_log();
  const std::vector<LogRecord> whole = records_of(log_);
  const std::vector<std::string> paths = segments();
  std::vector<std::string> contents;
  for (const std::string& path : paths) contents.push_back(bytes_of(path));
  std::size_t before = 0;
  for (std::size_t segment = 0; segment < paths.size(); ++segment) {
    std::size_t record_end = kSegmentHeaderBytes;
    for (std::size_t byte = 0; byte < contents[segment].size(); ++byte) {
      if (byte == record_end) {
        if (byte > kSegmentHeaderBytes) ++before;
        record_end +=
            kRecordHeaderBytes +
            parse_record_header(contents[segment].substr(byte, kRecordHeaderBytes))->length;
      }
      fs::remove_all(log_);
      fs::create_directory(log_);
      for (std::size_t i = 0; i < paths.size(); ++i) write_bytes(paths[i], contents[i]);
      std::string damaged = contents[segment];
      damaged[byte] = static_cast<char>(damaged[byte] ^ (1 << (byte % 8)));
      write_bytes(paths[segment], damaged);
      ASSERT_EQ(records_of(log_).size(), before) << "byte " << byte << " of segment " << segment;
      expect_a_good_beginning(
          whole, before,
          "bit of byte " + std::to_string(byte) + " of segment " + std::to_string(segment));
    }
    ++before;
  }
}

TEST_F(FrameLogTest, MissingSwappedAndForeignSegmentsEndIt) {
  write_log();
  const std::vector<LogRecord> whole = records_of(log_);
  const std::vector<std::string> paths = segments();
  const std::string second = bytes_of(paths[1]), third = bytes_of(paths[2]), garbage(1000, '\x5a');
  const std::size_t in_first = [&] {
    fs::remove(paths[1]);
    return records_of(log_).size();
  }();
  expect_a_good_beginning(whole, in_first, "a segment is missing");
  EXPECT_FALSE(fs::exists(paths[3])) << "what lies behind the end goes";

  fs::remove_all(log_);
  write_log();
  write_bytes(paths[1], third);
  write_bytes(paths[2], second);
  expect_a_good_beginning(whole, in_first, "two segments are swapped");

  fs::remove_all(log_);
  write_log();
  // Behind a header of its own, so that only the numbers of its records tell.
  write_bytes(paths[1], format_segment_header(1) + third.substr(kSegmentHeaderBytes));
  expect_a_good_beginning(whole, in_first, "records of another segment");

  fs::remove_all(log_);
  write_log();
  write_bytes(paths[1], second + garbage);
  const std::size_t in_two = records_of(log_).size();
  EXPECT_GT(in_two, in_first);
  expect_a_good_beginning(whole, in_two, "garbage behind a segment");
}

TEST_F(FrameLogTest, ALengthThatNobodyWroteCostsNoMemory) {
  fs::create_directory(log_);
  std::string header = format_record_header(RecordType::kTerms, 0, "");
  header.replace(8, 4, "\xff\xff\xff\x7f");
  write_bytes(log_ + "/" + segment_name(0), format_segment_header(0) + header);
  EXPECT_TRUE(records_of(log_).empty());
  header.replace(8, 4, std::string("\0\0\0\2", 4));  // 32 MiB: allowed, but they are not there
  write_bytes(log_ + "/" + segment_name(0), format_segment_header(0) + header);
  EXPECT_TRUE(records_of(log_).empty());
}

TEST_F(FrameLogTest, NoLogAndAnEmptyFolderAreSaidInAMessage) {
  const auto none = FrameLog::open(log_, told_.events());
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::kNotFound);
  fs::create_directory(log_);
  EXPECT_FALSE(FrameLog::open(log_, told_.events()).ok());
  EXPECT_FALSE(FrameLog::create(log_, "terms", "start", told_.events()).ok())
      << "a log is never written over";
}

TEST_F(FrameLogTest, FramesAreDurableInGroups) {
  FrameLogOptions options;
  options.group_time = std::chrono::milliseconds(200);
  options.group_bytes = 10'000;
  auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_TRUE(log.ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE((*log)->append(RecordType::kFrame, payload(i)).ok());
  EXPECT_EQ(told_.durable(), 0u) << "before the group's time";
  ASSERT_TRUE(told_.wait_for_durable(5));
  EXPECT_LE(told_.durable_calls(), 2);
}

TEST_F(FrameLogTest, AFullGroupDoesNotWaitForItsTime) {
  FrameLogOptions options;
  options.group_time = std::chrono::hours(1);
  options.group_bytes = 10'000;
  auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_TRUE(log.ok());
  ASSERT_TRUE((*log)->append(RecordType::kFrame, std::string(20'000, 'x')).ok());
  EXPECT_TRUE(told_.wait_for_durable(1));
}

TEST_F(FrameLogTest, AFullDiskIsSaidOnceAndWhatWasDurableIsThere) {
  // Room for so many bytes, of which the last write takes a part: as a real disk does.
  std::size_t room = 300;
  FrameLogOptions options;
  options.group_bytes = 1;
  options.write = [&room](int file, const void* bytes, std::size_t count) -> ssize_t {
    const std::size_t fits = std::min(count, room);
    room -= fits;
    if (fits > 0) return ::write(file, bytes, fits);
    errno = ENOSPC;
    return -1;
  };
  {
    auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
    ASSERT_TRUE(log.ok());
    for (int i = 0; i < 20; ++i) {
      if (!(*log)->append(RecordType::kFrame, payload(i)).ok()) break;
    }
    ASSERT_TRUE(told_.wait_for_failure());
    EXPECT_THAT(told_.failure(), HasSubstr("No space left"));
    const Status refused = (*log)->append(RecordType::kFrame, "one more");
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().message, told_.failure());
  }
  const std::uint64_t durable = told_.durable();
  EXPECT_LT(durable, 20u);
  const auto opened = FrameLog::open(log_, told_.events());
  ASSERT_TRUE(opened.ok());
  EXPECT_GE(opened->contents.frame_count, durable);
  EXPECT_GT(opened->contents.frame_count, 0u);
}

TEST_F(FrameLogTest, NothingIsDurableAfterAFailedSync) {
  int allowed = 3;  // of the header, of the first records, of the first frame
  FrameLogOptions options;
  options.group_bytes = 1;
  options.sync = [&allowed](int file) {
    if (allowed-- > 0) return ::fdatasync(file);
    errno = EIO;
    return -1;
  };
  auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_TRUE(log.ok());
  ASSERT_TRUE((*log)->append(RecordType::kFrame, payload(0)).ok());
  ASSERT_TRUE(told_.wait_for_durable(1));
  ASSERT_TRUE((*log)->append(RecordType::kFrame, payload(1)).ok());
  ASSERT_TRUE(told_.wait_for_failure());
  EXPECT_THAT(told_.failure(), HasSubstr("syncing"));
  allowed = 100;
  EXPECT_FALSE((*log)->append(RecordType::kFrame, payload(2)).ok())
      << "a sync that works later says nothing about what was lost";
  EXPECT_EQ(told_.durable(), 1u);
}

TEST_F(FrameLogTest, ClosingSaysWhetherAllWasWritten) {
  int allowed = 2;  // of the header, of the first records
  FrameLogOptions options;
  options.group_time = std::chrono::hours(1);  // nothing but the end makes it sync
  options.sync = [&allowed](int file) {
    if (allowed-- > 0) return ::fdatasync(file);
    errno = ENOSPC;
    return -1;
  };
  auto full = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_TRUE(full.ok());
  ASSERT_TRUE((*full)->append(RecordType::kFrame, payload(0)).ok());
  const Status failed = (*full)->close();
  ASSERT_FALSE(failed.ok());
  EXPECT_THAT(failed.error().message, HasSubstr("syncing"));
  EXPECT_FALSE((*full)->close().ok()) << "and says so again";

  auto log = FrameLog::create(log_ + "2", "terms", "start", told_.events());
  ASSERT_TRUE(log.ok());
  ASSERT_TRUE((*log)->append(RecordType::kFrame, payload(0)).ok());
  EXPECT_TRUE((*log)->close().ok());
}

TEST_F(FrameLogTest, ADiskThatIsFullFromTheStartGivesNoLog) {
  FrameLogOptions options;
  options.sync = [](int) {
    errno = ENOSPC;
    return -1;
  };
  const auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_FALSE(log.ok());
  EXPECT_EQ(log.error().code, ErrorCode::kIo);
}

TEST_F(FrameLogTest, ADiskThatIsTooSlowIsSaidInsteadOfTakingAllMemory) {
  std::mutex stuck;
  FrameLogOptions options;
  options.max_waiting_bytes = 1000;
  std::atomic<bool> held{false};
  options.write = [&](int file, const void* bytes, std::size_t count) {
    if (held) const std::lock_guard wait(stuck);
    return ::write(file, bytes, count);
  };
  auto log = FrameLog::create(log_, "terms", "start", told_.events(), options);
  ASSERT_TRUE(log.ok());
  {
    const std::lock_guard hold(stuck);
    held = true;
    int taken = 0;
    Status status = Done{};
    while (taken < 100 && (status = (*log)->append(RecordType::kFrame, std::string(100, 'x'))).ok())
      ++taken;
    EXPECT_EQ(taken, 10);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, ErrorCode::kBusy);
    EXPECT_THAT(status.error().message, HasSubstr("too slow"));
  }
  ASSERT_TRUE(told_.wait_for_durable(10));
  EXPECT_TRUE((*log)->append(RecordType::kFrame, "again").ok()) << "and it goes on";
}

}  // namespace
}  // namespace hermite::frame_log
