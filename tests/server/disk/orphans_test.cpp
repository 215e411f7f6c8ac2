#include "server/disk/orphans.h"

#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <filesystem>
#include <fstream>

#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kToday_ms = 1'800'000'000'000;
constexpr std::int64_t kKeep_ms = std::chrono::milliseconds(kKeepLost).count();

class OrphansTest : public testing::Test {
 protected:
  // A scan's files, without a row.
  std::string scan_files() {
    const std::string id = new_scan_id();
    EXPECT_TRUE(blobs_.put(id, "cloud.ply", "points").ok());
    fs::create_directory(data_.log_folder(id));
    std::ofstream(data_.log_folder(id) + "/segment-0000.rlog") << "frames";
    return id;
  }
  std::string scan(ScanPhase phase) {
    ScanRow row;
    row.id = scan_files();
    row.phase = phase;
    row.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
    EXPECT_TRUE(store_.scans.add(row).ok());
    return row.id;
  }
  std::string upload_file() {
    const std::string id = new_scan_id();
    std::ofstream(data_.upload_path(id)) << "half of it";
    return id;
  }
  std::string path(const std::string& below) const { return folder_ / ("data/" + below); }

  const test::TemporaryFolder folder_;
  const DataDirectory data_{folder_ / "data"};
  Store store_{data_.database_path()};
  FileBlobs blobs_{data_.scans_folder()};
};

TEST_F(OrphansTest, WhatARowKnowsStays) {
  const std::string finished = scan(ScanPhase::kFinished), running = scan(ScanPhase::kRunning);
  UploadRow upload;
  upload.id = upload_file();
  ASSERT_TRUE(store_.uploads.add(upload).ok());
  clear_orphans(data_, store_, kToday_ms);
  for (const std::string& id : {finished, running}) {
    EXPECT_TRUE(fs::exists(data_.scan_folder(id) + "/cloud.ply"));
    EXPECT_TRUE(fs::exists(data_.log_folder(id) + "/segment-0000.rlog"));
  }
  EXPECT_TRUE(fs::exists(data_.upload_path(upload.id)));
  EXPECT_TRUE(fs::is_empty(path("lost/scans")));
  EXPECT_TRUE(fs::is_empty(path("lost/uploads")));
}

TEST_F(OrphansTest, AScanThatNoRowKnowsIsLostAsAWhole) {
  const std::string id = scan_files();
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_FALSE(fs::exists(data_.scan_folder(id)));
  EXPECT_TRUE(fs::exists(path("lost/scans/" + id + "/cloud.ply")));
  EXPECT_TRUE(fs::exists(path("lost/scans/" + id + "/log/segment-0000.rlog")));
  // Taken back by a person who has found the database again.
  fs::rename(path("lost/scans/" + id), data_.scan_folder(id));
  EXPECT_EQ(*read_blob(blobs_, id, "cloud.ply", 100), "points");
}

TEST_F(OrphansTest, AnUploadThatNoRowKnowsIsLost) {
  const std::string id = upload_file();
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_FALSE(fs::exists(data_.upload_path(id)));
  EXPECT_TRUE(fs::exists(path("lost/uploads/" + id)));
}

TEST_F(OrphansTest, AJobThatIsToGoOnKnowsItsScan) {
  JobRow job;
  job.id = new_scan_id();
  job.scan_id = scan_files();
  ASSERT_TRUE(store_.jobs.add(job).ok());
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_TRUE(fs::exists(data_.scan_folder(job.scan_id)));
  job.state = JobState::kCancelled;
  ASSERT_TRUE(store_.jobs.update(job).ok());
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_FALSE(fs::exists(data_.scan_folder(job.scan_id)));
}

TEST_F(OrphansTest, WhatWasHalfWrittenGoesAndTheResultsStay) {
  const std::string id = scan(ScanPhase::kInterrupted);
  std::ofstream(data_.scan_folder(id) + "/cloud.ply.77-0.tmp") << "poi";
  std::ofstream(data_.log_folder(id) + "/segment-0001.rlog") << "frames";
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_FALSE(fs::exists(data_.scan_folder(id) + "/cloud.ply.77-0.tmp"));
  EXPECT_EQ(blobs_.list(id)->size(), 1u);
  EXPECT_TRUE(fs::exists(data_.log_folder(id) + "/segment-0001.rlog"));
}

TEST_F(OrphansTest, WhatWasLostLongAgoBecomesWaste) {
  const std::string scan = scan_files(), upload = upload_file();
  clear_orphans(data_, store_, kToday_ms);
  clear_orphans(data_, store_, kToday_ms + kKeep_ms);
  EXPECT_TRUE(fs::exists(path("lost/scans/" + scan)));
  clear_orphans(data_, store_, kToday_ms + kKeep_ms + 1);
  EXPECT_TRUE(fs::is_empty(path("lost/scans")));
  EXPECT_TRUE(fs::is_empty(path("lost/uploads")));
  EXPECT_EQ(data_.set_aside().waste().size(), 2u);
}

TEST_F(OrphansTest, WhatIsNoneOfOursStays) {
  fs::create_directory(path("scans/notes"));
  const std::string id = new_scan_id();
  std::ofstream(path("scans/" + id)) << "a file where folders are";
  fs::create_directory(path("uploads/" + id));
  clear_orphans(data_, store_, kToday_ms);
  for (const std::string& there : {std::string("scans/notes"), "scans/" + id, "uploads/" + id})
    EXPECT_TRUE(fs::exists(path(there)));
}

TEST_F(OrphansTest, ASecondOneOfTheSameIdStaysWhereItIs) {
  const std::string id = scan_files();
  clear_orphans(data_, store_, kToday_ms);
  ASSERT_TRUE(blobs_.put(id, "cloud.ply", "others").ok());
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_EQ(*read_blob(blobs_, id, "cloud.ply", 100), "others");
  EXPECT_TRUE(fs::exists(path("lost/scans/" + id)));
}

TEST_F(OrphansTest, AStoreThatCannotTellLosesNothing) {
  const std::string scan = scan_files(), upload = upload_file();
  SQLite::Database(data_.database_path(), SQLite::OPEN_READWRITE)
      .exec("DROP TABLE scans; DROP TABLE uploads");
  clear_orphans(data_, store_, kToday_ms);
  EXPECT_TRUE(fs::exists(data_.scan_folder(scan)));
  EXPECT_TRUE(fs::exists(data_.upload_path(upload)));
}

}  // namespace
}  // namespace hermite::server
