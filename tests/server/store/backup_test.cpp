#include "server/store/backup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/store/data_directory.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class BackupTest : public testing::Test {
 protected:
  void add_scan(Store& store, const DataDirectory& data) {
    ScanRow row;
    row.id = new_scan_id();
    row.title = "title";
    row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
    row.phase = ScanPhase::kFinished;
    ASSERT_TRUE(store.scans.add(row).ok());
    ASSERT_TRUE(data.create_scan_folder(row.id).ok());
    std::ofstream(data.scan_folder(row.id) + "/cloud.ply") << "points of " << row.id;
    ids_.push_back(row.id);
  }

  const test::TemporaryFolder folder_;
  std::vector<std::string> ids_;
};

TEST_F(BackupTest, WhatIsBackedUpUnderARunningServerComesBack) {
  {
    const DataDirectory data(folder_ / "data");
    Store store(data.database_path());
    for (int i = 0; i < 3; ++i) add_scan(store, data);
    fs::create_symlink("/etc/passwd", data.scan_folder(ids_[0]) + "/link");
    ASSERT_TRUE(store.notes.add({"n", ids_[1], {1, 2, 3}, std::nullopt, "a crack", 1, 7, 7}).ok());
    ASSERT_TRUE(data.create_job_folder(ids_[0]).ok());
    std::ofstream(data.job_folder(ids_[0]) + "/unpacked") << "is there in the upload too";
    const auto summary = back_up(folder_ / "data", folder_ / "backup");
    ASSERT_TRUE(summary.ok()) << summary.error().message;
    EXPECT_EQ(summary->scan_count, 3);
    EXPECT_EQ(summary->file_count, 4)
        << "three clouds and the token, no lock, no link, nothing of jobs";
    add_scan(store, data);  // too late
    EXPECT_EQ(store.scans.list()->size(), 4u) << "the server goes on";
  }
  const auto restored = restore(folder_ / "backup", folder_ / "restored");
  ASSERT_TRUE(restored.ok()) << restored.error().message;
  const DataDirectory data(folder_ / "restored");
  Store store(data.database_path());
  EXPECT_EQ(store.scans.list()->size(), 3u);
  ASSERT_EQ(store.notes.of_scan(ids_[1])->size(), 1u);
  EXPECT_EQ(store.notes.of_scan(ids_[1])->front().text, "a crack");
  EXPECT_EQ(content(data.scan_folder(ids_[1]) + "/cloud.ply"), "points of " + ids_[1]);
  EXPECT_EQ(content(folder_ / "restored/token"), content(folder_ / "data/token"));
  EXPECT_EQ(fs::status(folder_ / "backup/token").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_FALSE(fs::exists(data.scan_folder(ids_[0]) + "/link"));
}

TEST_F(BackupTest, NothingIsOverwritten) {
  {
    const DataDirectory data(folder_ / "data");
    Store store(data.database_path());
    add_scan(store, data);
  }
  ASSERT_TRUE(back_up(folder_ / "data", folder_ / "backup").ok());
  EXPECT_THAT(back_up(folder_ / "data", folder_ / "backup").error().message,
              HasSubstr("is there already"));
  EXPECT_THAT(restore(folder_ / "backup", folder_ / "data").error().message,
              HasSubstr("is not empty"));
  fs::create_directories(folder_ / "empty");
  EXPECT_TRUE(restore(folder_ / "backup", folder_ / "empty").ok());
  fs::create_directories(folder_ / "cut.partial");
  EXPECT_THAT(back_up(folder_ / "data", folder_ / "cut").error().message, HasSubstr("cut off"));
}

TEST_F(BackupTest, ARestoreThatWasCutOffIsBegunAnewAndStartsNoServer) {
  {
    const DataDirectory data(folder_ / "data");
    Store store(data.database_path());
    add_scan(store, data);
  }
  ASSERT_TRUE(back_up(folder_ / "data", folder_ / "backup").ok());
  const std::string restored = folder_ / "restored";
  fs::create_directories(restored + "/scans/half");
  { std::ofstream(restored + "/" + kRestoreMark) << ""; }
  EXPECT_THROW(DataDirectory{restored}, SetupError);
  EXPECT_FALSE(back_up(restored, folder_ / "another").ok());
  ASSERT_TRUE(restore(folder_ / "backup", restored).ok());
  EXPECT_FALSE(fs::exists(restored + "/scans/half"));
  EXPECT_FALSE(fs::exists(restored + "/" + kRestoreMark));
  const DataDirectory data(restored);
  EXPECT_TRUE(Store(data.database_path()).scans.find(ids_[0]).ok());
}

TEST_F(BackupTest, WhatIsNoDataFolderOrDamagedIsRefused) {
  EXPECT_EQ(back_up(folder_ / "nowhere", folder_ / "backup").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(restore(folder_ / "nowhere", folder_ / "data").error().code, ErrorCode::kNotFound);
  {
    const DataDirectory data(folder_ / "data");
    Store store(data.database_path());
    for (int i = 0; i < 200; ++i) add_scan(store, data);
  }
  ASSERT_TRUE(back_up(folder_ / "data", folder_ / "backup").ok());
  {
    std::fstream file(folder_ / "backup/hermite.db",
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(5000);
    file << std::string(20'000, '\xee');
  }
  const auto damaged = restore(folder_ / "backup", folder_ / "restored");
  ASSERT_FALSE(damaged.ok());
  EXPECT_EQ(damaged.error().code, ErrorCode::kCorruptData) << damaged.error().message;
  EXPECT_FALSE(fs::exists(folder_ / "restored"));
  fs::resize_file(folder_ / "backup/hermite.db", 100);
  EXPECT_FALSE(restore(folder_ / "backup", folder_ / "restored").ok());
}

}  // namespace
}  // namespace hermite::server
