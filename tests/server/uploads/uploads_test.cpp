#include "server/uploads/uploads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/digest/sha256.h"
#include "server/net/base64.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kNow_ms = 1'000'000'000'000, kKeep_ms = 1000;

class UploadsTest : public testing::Test {
 protected:
  UploadsTest() { open(); }
  void open() {
    uploads_.reset();
    quota_ = std::make_unique<StorageQuota>(
        storage_bytes_, [this] { return data_.scan_sizes(); }, LogReaders::Threads{now_, now_});
    uploads_ = std::make_unique<Uploads>(limits_, Storage{data_, store_, blobs_, waste_, *quota_},
                                         [this](const UploadRow& row) {
                                           completed_.push_back(row.id);
                                           return Status(Done{});
                                         });
  }
  UploadState create(std::int64_t length) {
    Result<UploadState> state = uploads_->create(length, "", grant_, kNow_ms);
    EXPECT_TRUE(state.ok()) << (state.ok() ? "" : state.error().message);
    return *state;
  }
  // Sends a piece that comes as a whole, or not.
  Result<UploadState> send(const UploadState& state, const std::string& bytes,
                           std::optional<Checksum> checksum = std::nullopt, bool complete = true) {
    const UploadPiece piece{state.offset_bytes,
                            static_cast<std::int64_t>(bytes.size()) + (complete ? 0 : 1),
                            std::move(checksum)};
    Result<std::shared_ptr<UploadWriter>> writer = uploads_->write(state, piece, grant_);
    if (!writer.ok()) return writer.error();
    EXPECT_TRUE((*writer)->write(bytes).ok());
    const Status closed = (*writer)->close(complete);
    Result<UploadState> now = uploads_->written(state, **writer, kNow_ms);
    if (!closed.ok()) return closed.error();
    return now;
  }
  std::string message_of(const Status& status) {
    return status.ok() ? "well" : status.error().message;
  }
  std::int64_t offset(const std::string& id) {
    return uploads_->find(id, grant_, kNow_ms)->offset_bytes;
  }

  const test::TemporaryFolder folder_;
  const DataDirectory data_{folder_ / "data"};
  Store store_{data_.database_path()};
  FileBlobs blobs_{data_.scans_folder()};
  const Waste::Post now_ = [](const std::function<void()>& action) { action(); };
  Waste waste_{data_.set_aside(), now_};
  std::uint64_t storage_bytes_ = 0;
  std::unique_ptr<StorageQuota> quota_;
  UploadLimits limits_{100, 150, 0, kKeep_ms};
  Grant grant_{"mine", {true, true, false}, "", 0};
  const Grant other_{"other", {true, true, false}, "", 0},
      admin_{"root", {true, true, true}, "", 0};
  std::vector<std::string> completed_;
  std::unique_ptr<Uploads> uploads_;
};

TEST_F(UploadsTest, PiecesMakeAWholeThatIsToldOnce) {
  UploadState state = create(10);
  state = *send(state, "hello");
  EXPECT_EQ(state.offset_bytes, 5);
  EXPECT_TRUE(completed_.empty());
  state = *send(state, "world");
  EXPECT_TRUE(state.complete());
  EXPECT_THAT(completed_, testing::ElementsAre(state.row.id));
  std::ifstream file(data_.upload_path(state.row.id));
  std::string bytes;
  file >> bytes;
  EXPECT_EQ(bytes, "helloworld");
}

TEST_F(UploadsTest, WhatWasCutStaysUnlessItHasAChecksum) {
  const UploadState state = create(10);
  ASSERT_TRUE(send(state, "hel", std::nullopt, false).ok());
  EXPECT_EQ(offset(state.row.id), 3);
  const UploadState at_three = *uploads_->find(state.row.id, grant_, kNow_ms);
  const Result<UploadState> cut =
      send(at_three, "lo", Checksum{ChecksumAlgorithm::kSha256, digest::sha256("lo!")}, false);
  ASSERT_FALSE(cut.ok());
  EXPECT_EQ(offset(state.row.id), 3);
}

TEST_F(UploadsTest, AWrongChecksumTakesThePieceBack) {
  const UploadState state = create(10);
  const Result<UploadState> wrong =
      send(state, "hello", Checksum{ChecksumAlgorithm::kSha256, digest::sha256("hallo")});
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(offset(state.row.id), 0);
  EXPECT_TRUE(
      send(state, "hello", Checksum{ChecksumAlgorithm::kSha256, digest::sha256("hello")}).ok());
  EXPECT_EQ(offset(state.row.id), 5);
}

TEST_F(UploadsTest, WhatADeadServerHadNotCheckedIsTakenBack) {
  const UploadState state = *send(create(10), "hello");
  {
    Result<std::shared_ptr<UploadWriter>> writer = uploads_->write(
        state, {5, 5, Checksum{ChecksumAlgorithm::kSha256, digest::sha256("world")}}, grant_);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE((*writer)->write("wor").ok());
    // Here the server dies.
  }
  open();
  EXPECT_EQ(offset(state.row.id), 5);
  EXPECT_EQ(store_.uploads.find(state.row.id)->unchecked_from, -1);
}

TEST_F(UploadsTest, AfterARestartAWholeOneIsToldAgain) {
  const UploadState whole = *send(create(5), "hello");
  create(5);
  completed_.clear();
  open();
  EXPECT_THAT(completed_, testing::ElementsAre(whole.row.id));
}

TEST_F(UploadsTest, ARowWithoutItsFileIsForgotten) {
  const UploadState state = create(5);
  std::filesystem::remove(data_.upload_path(state.row.id));
  open();
  EXPECT_FALSE(store_.uploads.find(state.row.id).ok());
}

TEST_F(UploadsTest, OneThatIsTooLongIsNamed) {
  const Result<UploadState> state = uploads_->create(101, "", grant_, kNow_ms);
  ASSERT_FALSE(state.ok());
  EXPECT_EQ(state.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(state.error().message, HasSubstr("Upload-Length is 101, allowed are 100 bytes"));
  EXPECT_EQ(uploads_->create(0, "", grant_, kNow_ms).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(UploadsTest, ATokenMayHaveSoMuchInAll) {
  create(100);
  const Result<UploadState> more = uploads_->create(51, "", grant_, kNow_ms);
  ASSERT_FALSE(more.ok());
  EXPECT_EQ(more.error().code, ErrorCode::kBusy);
  EXPECT_TRUE(uploads_->create(50, "", grant_, kNow_ms).ok());
  EXPECT_TRUE(uploads_->create(100, "", other_, kNow_ms).ok());
  EXPECT_TRUE(uploads_->create(100, "", admin_, kNow_ms).ok());
}

TEST_F(UploadsTest, ADeferredLengthIsHeldToTheLimitsAtEveryPiece) {
  create(100);
  UploadState state = create(-1);
  state = *send(state, std::string(40, 'x'));
  EXPECT_THAT(message_of(uploads_->write(state, {40, 20, {}}, grant_).ok()
                             ? Status(Done{})
                             : Error{ErrorCode::kBusy, "full"}),
              "full");
  EXPECT_EQ(uploads_->write(state, {40, 61, {}}, grant_).error().code, ErrorCode::kTooLarge);
  EXPECT_EQ(uploads_->set_length(state, 39, grant_).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(uploads_->set_length(state, 101, grant_).error().code, ErrorCode::kTooLarge);
  EXPECT_EQ(uploads_->set_length(state, 60, grant_).error().code, ErrorCode::kBusy);
  EXPECT_TRUE(uploads_->set_length(state, 45, grant_).ok());
  EXPECT_TRUE(send(state, "12345")->complete());
}

TEST_F(UploadsTest, ADiskThatMustStayFreeDoes) {
  limits_.min_free_disk_bytes = std::uint64_t{1} << 62;
  open();
  const Result<UploadState> state = uploads_->create(1, "", grant_, kNow_ms);
  ASSERT_FALSE(state.ok());
  EXPECT_THAT(state.error().message, HasSubstr("not enough room"));
}

TEST_F(UploadsTest, ScansAndUploadsShareTheStorage) {
  storage_bytes_ = 220;  // 11 are kept for administrators, 110 are for one token
  limits_.token_bytes = 0;
  ASSERT_TRUE(blobs_.put(new_scan_id(), "cloud.ply", std::string(100, 'x')).ok());
  open();
  const UploadState half = *send(create(60), std::string(30, 'x'));
  // 100 of the scan, 60 that were promised, of which 30 are there.
  const Result<UploadState> beyond = uploads_->create(61, "", admin_, kNow_ms);
  ASSERT_FALSE(beyond.ok()) << "also for who may administer";
  EXPECT_EQ(beyond.error().code, ErrorCode::kBusy);
  EXPECT_THAT(beyond.error().message, HasSubstr("the scans and uploads on this server take"));
  EXPECT_TRUE(send(half, std::string(30, 'x'))->complete()) << "what was promised is kept";
  UploadState unknown = create(-1);
  EXPECT_EQ(uploads_->set_length(unknown, 50, grant_).error().code, ErrorCode::kBusy);
  EXPECT_EQ(send(unknown, std::string(50, 'x')).error().code, ErrorCode::kBusy);
  EXPECT_TRUE(send(unknown, std::string(49, 'x')).ok());
  uploads_->forget(half.row.id);
  EXPECT_THAT(uploads_->create(62, "", grant_, kNow_ms).error().message,
              HasSubstr("of this token"));
  EXPECT_TRUE(uploads_->create(60, "", grant_, kNow_ms).ok());
}

TEST_F(UploadsTest, APieceElsewhereOrBeyondTheEndIsRefused) {
  const UploadState state = create(10);
  EXPECT_THAT(uploads_->write(state, {1, 1, {}}, grant_).error().message,
              HasSubstr("Upload-Offset is 1, and 0 bytes are here"));
  EXPECT_EQ(uploads_->write(state, {0, 11, {}}, grant_).error().code, ErrorCode::kTooLarge);
  Result<std::shared_ptr<UploadWriter>> writer = uploads_->write(state, {0, 2, {}}, grant_);
  ASSERT_TRUE(writer.ok());
  EXPECT_EQ((*writer)->write("abc").error().code, ErrorCode::kTooLarge)
      << "more than was announced";
}

TEST_F(UploadsTest, WhoeverWritesIsAskedToStop) {
  const UploadState state = create(10);
  EXPECT_TRUE(uploads_->is_free(state.row.id));
  Result<std::shared_ptr<UploadWriter>> writer = uploads_->write(state, {0, 5, {}}, grant_);
  ASSERT_TRUE(writer.ok());
  bool told = false;
  (*writer)->on_unwanted([&told] { told = true; });
  EXPECT_FALSE(uploads_->is_free(state.row.id));
  EXPECT_FALSE(told) << "it has only just begun: of many who come at once one gets through";
  EXPECT_FALSE(uploads_->is_free(state.row.id, true));
  EXPECT_TRUE(told);
  EXPECT_FALSE((*writer)->wanted());
  EXPECT_EQ(uploads_->list(grant_)->front().offset_bytes, -1)
      << "what is not on disk yet is not told";
  writer = Error{ErrorCode::kIo, "its connection is gone"};
  EXPECT_TRUE(uploads_->is_free(state.row.id));
}

TEST_F(UploadsTest, TheSameFileAgainIsTheFirstOne) {
  const auto put = [this](const std::string& metadata, const Grant& grant) {
    const UploadState state = *uploads_->create(5, metadata, grant, kNow_ms);
    const std::shared_ptr<UploadWriter> writer = *uploads_->write(state, {0, 5, {}, true}, grant);
    EXPECT_TRUE(writer->write("hello").ok());
    EXPECT_TRUE(writer->close(true).ok());
    const UploadState now = *uploads_->written(state, *writer, kNow_ms);
    return now.job_id.empty() ? now.row.id : now.job_id;
  };
  const std::string first = put("filename YQ==", grant_);
  JobRow job;
  job.id = job.source_id = first;
  ASSERT_TRUE(store_.jobs.add(job).ok());
  EXPECT_EQ(put("filename YQ==", grant_), first);
  EXPECT_EQ(uploads_->list(grant_)->size(), 1u) << "and its bytes are here once";
  EXPECT_NE(put("filename Yg==", grant_), first);
  EXPECT_NE(put("filename YQ==", other_), first);
  job.state = JobState::kFailed;
  ASSERT_TRUE(store_.jobs.update(job).ok());
  EXPECT_NE(put("filename YQ==", grant_), first) << "it is tried again";
}

// Four tus clients with the same file, in pieces that come in turn.
TEST_F(UploadsTest, TheSameFileSentAtTheSameTimeInPiecesIsOneJob) {
  std::vector<UploadState> states;
  for (int i = 0; i < 4; ++i) states.push_back(create(10));
  for (UploadState& state : states) state = *send(state, "hello");
  const Result<UploadState> wrong =
      send(states[3], "world", Checksum{ChecksumAlgorithm::kSha256, digest::sha256("other")});
  EXPECT_FALSE(wrong.ok());
  states[0] = *send(states[0], "world");
  JobRow job;
  job.id = job.source_id = states[0].row.id;
  ASSERT_TRUE(store_.jobs.add(job).ok());
  states[1] = *send(states[1], "world");
  EXPECT_EQ(states[1].job_id, job.id);
  EXPECT_EQ(uploads_->job_of(states[1].row.id), job.id) << "who asks by its own id is told, too";
  EXPECT_EQ(send(states[2], "World")->job_id, "") << "other bytes";
  EXPECT_EQ(send(states[3], "world")->job_id, "")
      << "a piece was taken back: what is there has no hash";
  EXPECT_EQ(completed_,
            (std::vector<std::string>{states[0].row.id, states[2].row.id, states[3].row.id}));
  job.state = JobState::kFinished;
  ASSERT_TRUE(store_.jobs.update(job).ok());
  EXPECT_EQ(send(*send(create(10), "hello"), "world")->job_id, "")
      << "who sends it later wants it once more";
}

TEST_F(UploadsTest, OthersDoNotFindIt) {
  const UploadState state = create(10);
  EXPECT_EQ(uploads_->find(state.row.id, other_, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(uploads_->remove(state.row.id, other_, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(uploads_->list(other_)->empty());
  EXPECT_TRUE(uploads_->find(state.row.id, admin_, kNow_ms).ok());
  for (const char* id : {"", "..", "../../hermite.db", "x"})
    EXPECT_EQ(uploads_->find(id, admin_, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(uploads_->remove(state.row.id, grant_, kNow_ms).ok());
  EXPECT_FALSE(std::filesystem::exists(data_.upload_path(state.row.id)));
}

TEST_F(UploadsTest, OneThatNobodyTouchesExpiresButNotWhileItsJobWaits) {
  const UploadState idle = create(10), used = *send(create(5), "hello");
  JobRow job;
  job.id = job.source_id = used.row.id;
  ASSERT_TRUE(store_.jobs.add(job).ok());
  EXPECT_FALSE(uploads_->find(idle.row.id, grant_, kNow_ms + kKeep_ms).ok());
  uploads_->sweep(kNow_ms + kKeep_ms);
  EXPECT_FALSE(std::filesystem::exists(data_.upload_path(idle.row.id)));
  EXPECT_TRUE(uploads_->find(used.row.id, grant_, kNow_ms + kKeep_ms).ok());
  EXPECT_EQ(uploads_->remove(used.row.id, grant_, kNow_ms).error().code, ErrorCode::kBusy);
  job.state = JobState::kFailed;
  ASSERT_TRUE(store_.jobs.update(job).ok());
  uploads_->keep(used.row.id, kNow_ms + kKeep_ms);
  uploads_->sweep(kNow_ms + 2 * kKeep_ms - 1);
  EXPECT_TRUE(std::filesystem::exists(data_.upload_path(used.row.id)));
  uploads_->sweep(kNow_ms + 2 * kKeep_ms);
  EXPECT_FALSE(std::filesystem::exists(data_.upload_path(used.row.id)));
}

}  // namespace
}  // namespace hermite::server
