#include "server/store/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/server/store/store_contract.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using test::scan_row;
using testing::HasSubstr;

class SqliteWorld {
 public:
  Store& store() { return *store_; }
  void restart() {
    store_.reset();
    store_ = std::make_unique<Store>(path_);
  }
  // What a killed server leaves behind: the files as they are now, without a clean close.
  void die() {
    const std::string left = folder_ / "left-" + std::to_string(++death_count_);
    for (const char* end : {"", "-wal"}) std::filesystem::copy_file(path_ + end, left + end);
    path_ = left;
    store_ = std::make_unique<Store>(path_);
  }

 private:
  const test::TemporaryFolder folder_;
  std::string path_ = folder_ / "db";
  int death_count_ = 0;
  std::unique_ptr<Store> store_ = std::make_unique<Store>(path_);
};

std::string store_message(const std::string& path) {
  try {
    Store store(path);
  } catch (const SetupError& error) {
    return error.what();
  }
  return "opened";
}

TEST(SqliteDatabase, RefusesANewerSchemaAndLeavesItAlone) {
  const test::TemporaryFolder folder;
  { Store store(folder / "db"); }
  {
    SQLite::Database database(folder / "db", SQLite::OPEN_READWRITE);
    database.exec("PRAGMA user_version = 99");
  }
  EXPECT_THAT(store_message(folder / "db"), HasSubstr("schema 99"));
  SQLite::Database database(folder / "db", SQLite::OPEN_READONLY);
  EXPECT_EQ(database.execAndGet("PRAGMA user_version").getInt(), 99);
}

TEST(SqliteDatabase, RefusesTheDatabaseOfAnotherProgram) {
  const test::TemporaryFolder folder;
  {
    SQLite::Database database(folder / "db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    database.exec("CREATE TABLE other(a)");
  }
  EXPECT_THAT(store_message(folder / "db"), HasSubstr("another program"));
}

TEST(SqliteDatabase, RefusesWhatIsNoDatabase) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "db") << std::string(5000, 'x');
  EXPECT_THAT(store_message(folder / "db"), HasSubstr("database"));
  EXPECT_THAT(store_message(folder / "no/such/folder"), HasSubstr("no/such/folder"));
}

// A page of the file is overwritten behind the store's back, as a disk does it that forgets.
void damage(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096 + 8);
  file << std::string(2000, '\x7f');
}

TEST(SqliteDatabase, SaysThatItIsDamaged) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "db");
    for (int i = 0; i < 200; ++i)
      ASSERT_TRUE(store.scans.add(scan_row("scan " + std::to_string(i))).ok());
  }
  damage(folder / "db");
  const Store store(folder / "db");  // not after a crash: it was not looked at
  const Status whole = store.check_integrity();
  ASSERT_FALSE(whole.ok());
  EXPECT_EQ(whole.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(whole.error().message, HasSubstr("damaged"));
}

TEST(SqliteDatabase, IsCheckedBesideChanges) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  std::thread checking([&store] {
    for (int i = 0; i < 20; ++i) {
      const Status whole = store.check_integrity();
      EXPECT_TRUE(whole.ok()) << whole.error().message;
    }
  });
  for (int i = 0; i < 200; ++i)
    EXPECT_TRUE(store.scans.add(scan_row("scan " + std::to_string(i))).ok());
  checking.join();
}

TEST(SqliteDatabase, ItsFilesAreNobodyElses) {
  const test::TemporaryFolder folder;
  const auto mode_of = [&folder](const std::string& name) {
    struct stat status {};
    return stat((folder / name).c_str(), &status) == 0 ? static_cast<int>(status.st_mode & 0777)
                                                       : -1;
  };
  { Store store(folder / "db"); }
  chmod((folder / "db").c_str(), 0644);
  Store store(folder / "db");
  ScanRow row;
  row.id = "a";
  ASSERT_TRUE(store.scans.add(row).ok());
  for (const char* name : {"db", "db-wal", "db-shm"}) EXPECT_EQ(mode_of(name), 0600) << name;
}

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Sqlite, StoreContract, server::SqliteWorld);
}  // namespace hermite::test
