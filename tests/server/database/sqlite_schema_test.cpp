// Databases of earlier versions, through the door of Store. golden/schema-1.db was written by the
// hermite whose schema was 1, schema-5.db made of it by the statements of the one whose schema was
// 5, with two measurements, and schema-6.db made of that in the same way, with a height.
#include "server/database/sqlite_schema.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/digest/sha256.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/source_root/source_root.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

class MigrationsTest : public testing::Test {
 protected:
  void take_golden(int version) {
    const std::string name = "schema-" + std::to_string(version) + ".db";
    std::filesystem::copy_file(test::source_root() / "tests/server/database/golden" / name, path_);
  }
  static int version_of(const std::string& path) {
    SQLite::Database database(path, SQLite::OPEN_READONLY);
    return database.execAndGet("PRAGMA user_version").getInt();
  }
  static std::string bytes_of(const std::string& path) {
    const std::vector<std::uint8_t> bytes = test::file_bytes(path);
    return {bytes.begin(), bytes.end()};
  }
  std::string open_message() const {
    try {
      Store store(path_);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "opened";
  }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "db";
};

TEST_F(MigrationsTest, TheFirstVersionsScansAreThereAfterwards) {
  take_golden(1);
  {
    Store store(path_);
    const auto rows = store.scans.list();
    ASSERT_TRUE(rows.ok()) << rows.error().message;
    ASSERT_EQ(rows->size(), 2u);
    EXPECT_EQ((*rows)[1].id, "ieazy7z5rmm64yfukj5s1pwofg");
    EXPECT_EQ((*rows)[1].title, "synthetic room");
    EXPECT_EQ((*rows)[1].phase, ScanPhase::kFinished);
    EXPECT_EQ((*rows)[1].frames_processed, 3);
    TokenRow share;
    share.id = "s";
    share.secret_sha256 = digest::sha256("s");
    share.scopes.view = true;
    share.scan_id = (*rows)[0].id;
    EXPECT_TRUE(store.tokens.add(share).ok());
  }
  EXPECT_EQ(version_of(path_), schema_version());
}

TEST_F(MigrationsTest, DistancesThatWereKeptAreThereAfterwards) {
  take_golden(5);
  Store store(path_);
  const auto rows = store.measurements.of_scan("ieazy7z5rmm64yfukj5s1pwofg");
  ASSERT_TRUE(rows.ok()) << rows.error().message;
  ASSERT_EQ(rows->size(), 2u);
  const MeasurementRow& door = (*rows)[0];
  EXPECT_EQ(door.name, "Door");
  EXPECT_EQ(door.kind, "distance");
  using ::testing::DoubleEq;
  using ::testing::ElementsAre;
  EXPECT_THAT(door.points,
              ElementsAre(ElementsAre(DoubleEq(0.1), DoubleEq(-0.2), DoubleEq(1.9)),
                          ElementsAre(DoubleEq(1.2), DoubleEq(1.0 / 3), DoubleEq(2.1))));
  EXPECT_TRUE(door.normals.empty());
  EXPECT_FALSE(door.up.has_value());
  EXPECT_EQ(door.value, 1.2345678901234567);
  EXPECT_EQ(door.half_width, 0.0031);
  EXPECT_EQ((*rows)[1].name, "Table");
  ASSERT_TRUE(store.measurements.remove("ieazy7z5rmm64yfukj5s1pwofg", door.id).ok());
  EXPECT_EQ(store.measurements.of_scan("ieazy7z5rmm64yfukj5s1pwofg")->size(), 1u);
}

TEST_F(MigrationsTest, ScansOfBeforeThereWereNotesMayHaveThem) {
  take_golden(6);
  const std::string scan_id = "ieazy7z5rmm64yfukj5s1pwofg";
  Store store(path_);
  const auto measurements = store.measurements.of_scan(scan_id);
  ASSERT_TRUE(measurements.ok()) << measurements.error().message;
  ASSERT_EQ(measurements->size(), 3u);
  EXPECT_EQ((*measurements)[2].name, "Shelf");
  EXPECT_EQ((*measurements)[2].kind, "height");
  EXPECT_EQ((*measurements)[2].points.size(), 2u);
  ASSERT_TRUE(store.notes.of_scan(scan_id).ok());
  EXPECT_TRUE(store.notes.of_scan(scan_id)->empty());
  ASSERT_TRUE(store.notes.add({"n", scan_id, {1, 2, 3}, std::nullopt, "a crack", 1, 7, 7}).ok());
  EXPECT_EQ(store.notes.of_scan(scan_id)->size(), 1u);
}

TEST_F(MigrationsTest, ABackupIsMadeFirst) {
  take_golden(1);
  { Store store(path_); }
  const std::string backup = backup_path(path_, 1);
  EXPECT_EQ(version_of(backup), 1);
  SQLite::Database database(backup, SQLite::OPEN_READONLY);
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM scans").getInt(), 2);
  EXPECT_EQ(database.execAndGet("PRAGMA integrity_check").getString(), "ok");
  EXPECT_FALSE(std::filesystem::exists(backup + ".partial"));
}

TEST_F(MigrationsTest, WithoutABackupNothingIsChanged) {
  take_golden(1);
  std::filesystem::create_directories(backup_path(path_, 1) + ".partial/in the way");
  EXPECT_THAT(open_message(), HasSubstr("before it is changed"));
  EXPECT_EQ(version_of(path_), 1);
}

TEST_F(MigrationsTest, AHalfWrittenBackupOfAnEarlierTryIsReplaced) {
  take_golden(1);
  std::ofstream(backup_path(path_, 1) + ".partial") << "half";
  EXPECT_EQ(open_message(), "opened");
  EXPECT_EQ(version_of(backup_path(path_, 1)), 1);
}

TEST_F(MigrationsTest, AStepThatFailsLeavesTheDatabaseAsItWas) {
  take_golden(1);
  {
    SQLite::Database database(path_, SQLite::OPEN_READWRITE);
    database.exec("CREATE TABLE tokens(in_the_way)");
  }
  EXPECT_THAT(open_message(), HasSubstr("tokens"));
  EXPECT_EQ(version_of(path_), 1);
}

TEST_F(MigrationsTest, ANewDatabaseNeedsNoBackup) {
  { Store store(path_); }
  EXPECT_EQ(version_of(path_), schema_version());
  EXPECT_FALSE(std::filesystem::exists(backup_path(path_, 0)));
  { Store store(path_); }
  EXPECT_FALSE(std::filesystem::exists(backup_path(path_, schema_version())));
}

TEST_F(MigrationsTest, ADamagedDatabaseOfADeadServerIsNotUsed) {
  {
    Store store(path_);
    ScanRow row;
    row.id = "a";
    row.title = std::string(20'000, 't');
    row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
    ASSERT_TRUE(store.scans.add(row).ok());
    // The files as a killed server leaves them: a write-ahead log with something in it.
    std::filesystem::copy_file(path_ + "-wal", folder_ / "left-wal");
  }
  std::string bytes = bytes_of(path_);
  ASSERT_GT(bytes.size(), 3u * 4096);
  for (std::size_t page = 1; page < bytes.size() / 4096; ++page)
    bytes.replace(page * 4096, 64, std::string(64, '\xee'));
  std::ofstream(path_, std::ios::binary) << bytes;
  std::string wal = bytes_of(folder_ / "left-wal");
  wal.replace(24, 8, std::string(8, '\0'));  // its checksum: SQLite takes nothing from it
  std::ofstream(path_ + "-wal", std::ios::binary) << wal;
  EXPECT_THAT(open_message(), HasSubstr("damaged"));
}

}  // namespace
}  // namespace hermite::server
