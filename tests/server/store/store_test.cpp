#include "server/store/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using testing::HasSubstr;

ScanRow row_of(const std::string& id, std::int64_t created_at_ms) {
  ScanRow row;
  row.id = id;
  row.title = "title of " + id + " 'quoted'; --";
  row.camera = {640, 480, 525.5, 524.5, 319.5, 239.5, 5000};
  row.created_at_ms = created_at_ms;
  return row;
}

std::string words_of_open(const std::string& path) {
  try {
    Store store(path);
  } catch (const SetupError& error) {
    return error.what();
  }
  return "opened";
}

TEST(Store, KeepsRowsOverARestart) {
  const test::TemporaryFolder folder;
  ScanRow row = row_of("a", 1000);
  {
    Store store(folder / "db");
    ASSERT_TRUE(store.add(row).ok());
    row.phase = ScanPhase::kFinished;
    row.words = "all well";
    row.frames_received = 10;
    row.frames_processed = 9;
    row.frames_dropped = 1;
    row.finished_at_ms = 2000;
    ASSERT_TRUE(store.update(row).ok());
  }
  Store store(folder / "db");
  const Result<ScanRow> found = store.find("a");
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->title, row.title);
  EXPECT_EQ(found->phase, ScanPhase::kFinished);
  EXPECT_EQ(found->words, "all well");
  EXPECT_EQ(found->camera, row.camera);
  EXPECT_EQ(found->frames_received, 10);
  EXPECT_EQ(found->frames_processed, 9);
  EXPECT_EQ(found->frames_dropped, 1);
  EXPECT_EQ(found->created_at_ms, 1000);
  EXPECT_EQ(found->finished_at_ms, 2000);
}

TEST(Store, ListsNewestFirst) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  for (const auto& [id, time] : {std::pair{"b", 2}, std::pair{"c", 3}, std::pair{"a", 1}}) ASSERT_TRUE(store.add(row_of(id, time)).ok());
  const auto rows = store.list();
  ASSERT_TRUE(rows.ok());
  ASSERT_EQ(rows->size(), 3u);
  EXPECT_EQ((*rows)[0].id, "c");
  EXPECT_EQ((*rows)[2].id, "a");
}

TEST(Store, AnIdIsThereOnce) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  ASSERT_TRUE(store.add(row_of("a", 1)).ok());
  const Status again = store.add(row_of("a", 2));
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().code, ErrorCode::kInvalidArgument);
}

TEST(Store, WhatIsNotThereIsNotFound) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  EXPECT_EQ(store.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store.update(row_of("a", 1)).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store.remove("a").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(store.add(row_of("a", 1)).ok());
  EXPECT_TRUE(store.remove("a").ok());
  EXPECT_EQ(store.find("a").error().code, ErrorCode::kNotFound);
}

TEST(Store, ScansThatADeadServerLeftRunningAreFoundOldestFirst) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  ASSERT_TRUE(store.add(row_of("younger", 3)).ok());
  ASSERT_TRUE(store.add(row_of("older", 1)).ok());
  ScanRow finished = row_of("finished", 2);
  finished.phase = ScanPhase::kFinished;
  ASSERT_TRUE(store.add(finished).ok());
  const auto running = store.running();
  ASSERT_TRUE(running.ok());
  ASSERT_EQ(running->size(), 2u);
  EXPECT_EQ((*running)[0].id, "older");
  EXPECT_EQ((*running)[1].id, "younger");
}

TEST(Store, RefusesANewerSchemaAndLeavesItAlone) {
  const test::TemporaryFolder folder;
  { Store store(folder / "db"); }
  {
    SQLite::Database database(folder / "db", SQLite::OPEN_READWRITE);
    database.exec("PRAGMA user_version = 99");
  }
  EXPECT_THAT(words_of_open(folder / "db"), HasSubstr("schema 99"));
  SQLite::Database database(folder / "db", SQLite::OPEN_READONLY);
  EXPECT_EQ(database.execAndGet("PRAGMA user_version").getInt(), 99);
}

TEST(Store, RefusesTheDatabaseOfAnotherProgram) {
  const test::TemporaryFolder folder;
  {
    SQLite::Database database(folder / "db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    database.exec("CREATE TABLE other(a)");
  }
  EXPECT_THAT(words_of_open(folder / "db"), HasSubstr("another program"));
}

TEST(Store, RefusesWhatIsNoDatabase) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "db") << std::string(5000, 'x');
  EXPECT_THAT(words_of_open(folder / "db"), HasSubstr("database"));
  EXPECT_THAT(words_of_open(folder / "no/such/folder"), HasSubstr("no/such/folder"));
}

TEST(Store, IsDurableBeforeAddReturns) {
  const test::TemporaryFolder folder;
  Store store(folder / "db");
  ASSERT_TRUE(store.add(row_of("a", 1)).ok());
  // What a killed server leaves behind: the files as they are now, without a clean close.
  std::filesystem::create_directory(folder / "copy");
  for (const char* name : {"db", "db-wal"}) std::filesystem::copy_file(folder / name, folder / "copy" + std::string("/") + name);
  Store copy(folder / "copy/db");
  EXPECT_TRUE(copy.find("a").ok());
}

TEST(Store, SaysWhetherItTakesChanges) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "hermite.db";
  Store store(path);
  EXPECT_TRUE(store.writable().ok());
  EXPECT_TRUE(store.writable().ok()) << "and leaves no transaction behind";
  EXPECT_TRUE(store.list().ok());
}

}  // namespace
}  // namespace hermite
