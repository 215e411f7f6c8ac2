// Rows move between a folder's file and PostgreSQL, and a server finds them where they are.
#include "server/store/rows_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "server/database/postgres_database.h"
#include "server/store/backup.h"
#include "server/store/data_directory.h"
#include "server/store/place_note.h"
#include "tests/support/postgres/postgres_server.h"
#include "tests/support/store_rows.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace rows_place_test {
namespace {

using test::PostgresServer;
using testing::HasSubstr;

class RowsPlaceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresServer::missing().empty()) GTEST_SKIP() << PostgresServer::missing();
    server_ = PostgresServer::shared();
    url_ = server_->url(server_->new_database());
    const DataDirectory made(data_);
  }
  Store opened(const std::string& address = "") const { return Store(open_rows(data_, address)); }
  std::string why_not_opened(const std::string& data, const std::string& address) const {
    try {
      open_rows(data, address);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "opened";
  }
  // Some rows of each kind, with what is hard to copy.
  void fill(Store store) const {
    ASSERT_TRUE(store.scans.add(test::scan_row("scan", 7)).ok());
    ScanRow odd = test::scan_row("odd");
    odd.message = std::string("no UTF-8: \xFF, and \0 too", 22);
    odd.camera.fx = 0.1 + 0.2;
    ASSERT_TRUE(store.scans.add(odd).ok());
    ASSERT_TRUE(store.tokens.add(test::token_row("token")).ok());
    ASSERT_TRUE(store.tokens.add(test::share_row("share", "scan")).ok());
    UploadRow upload;
    upload.id = "upload";
    ASSERT_TRUE(store.uploads.add(upload).ok());
    JobRow job = test::job_row();
    job.id = "job";
    ASSERT_TRUE(store.jobs.add(job).ok());
    for (const char* line : {"one", "two", ""})
      ASSERT_TRUE(store.jobs.add_line("job", {5, line}).ok());
    MeasurementRow measurement{"m", "scan",       "width", "distance", {{1, 2, 3}, {4, 5, 0.1}},
                               {},  std::nullopt, 5.2,     0.01,       9};
    ASSERT_TRUE(store.measurements.add(measurement).ok());
    measurement = {
        "h", "scan", "height", "height", {{1, 2, 3}}, {{0, 0, 1}}, MeasurementRow::Triple{0, 1, 0},
        1,   0.01,   9};
    ASSERT_TRUE(store.measurements.add(measurement).ok());
    NoteRow note;
    note.id = "note";
    note.scan_id = "scan";
    note.text = "a \xE2\x82\xAC";
    note.view = NoteView{{1, 2, 3}, {4, 5, 6}};
    ASSERT_TRUE(store.notes.add(note).ok());
  }
  void expect_full(Store store) const {
    EXPECT_EQ(test::ids_of(store.scans.list()), (std::vector<std::string>{"scan", "odd"}));
    EXPECT_EQ(store.scans.find("odd")->camera.fx, 0.1 + 0.2);
    EXPECT_EQ(store.tokens.list()->size(), 2u);
    EXPECT_EQ(store.tokens.with_secret(test::token_row("token").secret_sha256)->id, "token");
    EXPECT_EQ(store.uploads.list()->size(), 1u);
    EXPECT_EQ(store.jobs.lines_of("job")->size(), 3u);
    EXPECT_EQ(store.measurements.of_scan("scan")->at(0).up, (MeasurementRow::Triple{0, 1, 0}));
    EXPECT_EQ(store.measurements.of_scan("scan")->at(1).points[1][2], 0.1);
    EXPECT_EQ(store.notes.of_scan("scan")->at(0).view->target_m[2], 6);
  }
  bool has(const std::string& name) const { return std::filesystem::exists(data_ + "/" + name); }

  const test::TemporaryFolder folder_;
  const std::string data_ = folder_ / "data";
  PostgresServer* server_ = nullptr;
  std::string url_;
};

TEST_F(RowsPlaceTest, TheyMoveThereAndBack) {
  fill(opened());
  const CopySummary there = *move_rows_to_postgres(data_, url_);
  EXPECT_EQ(there.scan_count, 2);
  EXPECT_EQ(there.row_count, 15);
  EXPECT_FALSE(has("hermite.db"));
  EXPECT_TRUE(has("hermite.db.moved"));
  expect_full(opened());  // the folder says where they are
  expect_full(opened(url_));
  EXPECT_FALSE(has("hermite.db"));
  ASSERT_TRUE(opened().scans.label("odd", {"changed there", {{"a", "b c"}}}).ok());

  const CopySummary back = *move_rows_to_folder(data_, url_);
  EXPECT_EQ(back.row_count, 15);
  EXPECT_FALSE(has("rows-at") || has("rows-moving") || has("hermite.db.moved"));
  expect_full(opened());
  EXPECT_EQ(opened().scans.find("odd")->title, "changed there");
  EXPECT_EQ(opened().scans.find("odd")->tags, (std::vector<std::string>{"a", "b c"}));
  // The database is free for another folder.
  const DataDirectory other(folder_ / "other");
  EXPECT_EQ(why_not_opened(folder_ / "other", url_), "opened");
  EXPECT_TRUE(Store(open_rows(folder_ / "other", "")).scans.list()->empty());
}

TEST_F(RowsPlaceTest, ANewFolderIsJoinedToANewDatabase) {
  fill(opened(url_));
  expect_full(opened());
  EXPECT_FALSE(has("hermite.db"));
  // The same database by another name, as after a move of its server.
  std::string other_name = url_;
  other_name.replace(other_name.find("127.0.0.1"), 9, "localhost");
  expect_full(opened(other_name));
  EXPECT_THAT((*read_place_note(data_ + "/rows-at"))->address, HasSubstr("localhost"));
}

TEST_F(RowsPlaceTest, NeitherSharesWithAnother) {
  fill(opened(url_));
  const DataDirectory other(folder_ / "other");
  EXPECT_THAT(why_not_opened(folder_ / "other", url_), HasSubstr("another folder"));
  EXPECT_THAT(why_not_opened(data_, server_->url(server_->new_database())),
              HasSubstr("created anew"));
  { const Store in_file(open_rows(folder_ / "other", "")); }
  EXPECT_THAT(why_not_opened(folder_ / "other", url_), HasSubstr("move them first"));
  EXPECT_EQ(move_rows_to_postgres(folder_ / "other", url_).error().code, ErrorCode::kBusy);
  EXPECT_EQ(move_rows_to_postgres(data_, url_).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(move_rows_to_folder(folder_ / "other", url_).error().code, ErrorCode::kInvalidArgument);
  expect_full(opened());
}

// After each step of a move the process is killed: the rows are found where they are, and the same
// move ends.
TEST_F(RowsPlaceTest, AnInterruptedMoveIsStartedAgain) {
  fill(opened());
  // Before the copy.
  ASSERT_TRUE(write_place_note(data_ + "/rows-moving", {url_, "0123456789ab"}).ok());
  expect_full(opened());
  ASSERT_TRUE(move_rows_to_postgres(data_, url_).ok());
  // After the copy, before the note has its name: the file counts, and has changed since.
  ASSERT_TRUE(rename_in_folder(data_, "rows-at", "rows-moving").ok());
  ASSERT_TRUE(rename_in_folder(data_, "hermite.db.moved", "hermite.db").ok());
  ASSERT_TRUE(opened().scans.label("odd", {"changed here", std::nullopt}).ok());
  ASSERT_TRUE(move_rows_to_postgres(data_, url_).ok());
  EXPECT_EQ(opened().scans.find("odd")->title, "changed here");
  // On the way back, after the copy: the database counts.
  std::ofstream(data_ + "/hermite.db.unfinished") << "cut";
  std::ofstream(data_ + "/hermite.db.unfinished-wal") << "cut";
  ASSERT_TRUE(move_rows_to_folder(data_, url_).ok());
  expect_full(opened());
  // After the note has its other name: what is left to do is to empty the database.
  ASSERT_TRUE(move_rows_to_postgres(data_, url_).ok());
  std::filesystem::copy_file(data_ + "/hermite.db.moved", data_ + "/hermite.db");
  ASSERT_TRUE(rename_in_folder(data_, "rows-at", "rows-moving").ok());
  expect_full(opened());
  ASSERT_TRUE(move_rows_to_folder(data_, url_).ok());
  EXPECT_FALSE(has("rows-moving"));
  expect_full(opened());
}

TEST_F(RowsPlaceTest, ABackupHasThemWhereverTheyAre) {
  fill(opened(url_));
  const Store running = opened();  // a backup does not mind
  const BackupSummary made = *back_up(data_, folder_ / "backup");
  EXPECT_EQ(made.scan_count, 2);
  ASSERT_TRUE(restore(folder_ / "backup", folder_ / "restored").ok());
  expect_full(Store(open_rows(folder_ / "restored", "")));
}

// A rule that the database has beyond Hermite's: the copy fails as a whole.
TEST_F(RowsPlaceTest, WhatIsRefusedOnTheWayIsNotMoved) {
  fill(opened());
  const std::string name = server_->new_database();
  { const PostgresDatabase made(server_->url(name)); }
  server_->run(name, "ALTER TABLE notes ADD CHECK (text = 'nothing')");
  const Result<CopySummary> refused = move_rows_to_postgres(data_, server_->url(name));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("notes"));
  expect_full(opened());
  EXPECT_TRUE(Store(std::make_unique<PostgresDatabase>(server_->url(name))).scans.list()->empty());
}

}  // namespace
}  // namespace rows_place_test
}  // namespace hermite::server
