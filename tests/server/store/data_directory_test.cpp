#include "server/store/data_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

std::string open_message(const std::string& path) {
  try {
    DataDirectory directory(path);
  } catch (const SetupError& error) {
    return error.what();
  }
  return "opened";
}

int mode_of(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? static_cast<int>(status.st_mode & 0777) : -1;
}

TEST(DataDirectory, MakesAPrivateTokenAndKeepsIt) {
  const test::TemporaryFolder folder;
  std::string token;
  {
    const DataDirectory directory(folder / "data");
    token = directory.token();
  }
  EXPECT_EQ(token.size(), 64u);
  EXPECT_EQ(mode_of(folder / "data/token"), 0600);
  EXPECT_EQ(mode_of(folder / "data"), 0700);
  const DataDirectory again(folder / "data");
  EXPECT_EQ(again.token(), token);
}

TEST(DataDirectory, MakesATokenThatOthersCouldReadPrivateAgain) {
  const test::TemporaryFolder folder;
  { const DataDirectory directory(folder / "data"); }
  chmod((folder / "data/token").c_str(), 0644);
  const DataDirectory again(folder / "data");
  EXPECT_EQ(mode_of(folder / "data/token"), 0600);
}

TEST(DataDirectory, IsOneServersAlone) {
  const test::TemporaryFolder folder;
  {
    const DataDirectory first(folder / "data");
    EXPECT_THAT(open_message(folder / "data"), HasSubstr("another server"));
  }
  EXPECT_EQ(open_message(folder / "data"), "opened");
}

TEST(DataDirectory, StaysOneServersAloneWhenSomebodyDeletesTheLockFile) {
  const test::TemporaryFolder folder;
  const DataDirectory first(folder / "data");
  ASSERT_TRUE(std::filesystem::remove(folder / "data/lock"));
  EXPECT_THAT(open_message(folder / "data"), HasSubstr("another server"));
}

TEST(DataDirectory, IsClosedToOtherUsersWhoeverMadeIt) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "data");
  for (const auto& [found, left] : {std::pair{0755, 0700}, std::pair{0777, 0700},
                                    std::pair{0750, 0750}, std::pair{0700, 0700}}) {
    chmod((folder / "data").c_str(), static_cast<mode_t>(found));
    const DataDirectory directory(folder / "data");
    EXPECT_EQ(mode_of(folder / "data"), left);
  }
}

TEST(DataDirectory, RefusesATokenFileWithoutAToken) {
  const test::TemporaryFolder folder;
  for (const std::string& text :
       {std::string(), std::string("short\n"), std::string(64, 'G'), std::string(65, 'a')}) {
    std::filesystem::create_directories(folder / "data");
    std::ofstream(folder / "data/token", std::ios::trunc) << text;
    EXPECT_THAT(open_message(folder / "data"), HasSubstr("token")) << text;
  }
}

TEST(DataDirectory, SaysWhatCannotBeCreated) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  EXPECT_THAT(open_message(folder / "file/data"), HasSubstr("file/data"));
}

TEST(DataDirectory, CreatesAndRemovesAScansFolder) {
  const test::TemporaryFolder folder;
  const DataDirectory directory(folder / "data");
  const std::string id = new_scan_id();
  ASSERT_TRUE(directory.create_scan_folder(id).ok());
  std::ofstream(directory.scan_folder(id) + "/cloud.ply") << "x";
  EXPECT_FALSE(directory.create_scan_folder(id).ok());
  ASSERT_TRUE(directory.remove_scan_folder(id).ok());
  EXPECT_FALSE(std::filesystem::exists(directory.scan_folder(id)));
}

TEST(DataDirectoryDeathTest, MakesNoPathFromAnythingButAnId) {
  const test::TemporaryFolder folder;
  const DataDirectory directory(folder / "data");
  EXPECT_DEATH(directory.scan_folder("../../etc"), "no scan id");
}

TEST(DataDirectory, TellsOtherProgramsWhereItsServerListens) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(published_server(folder / "none").error().code, ErrorCode::kNotFound);
  {
    const DataDirectory directory(folder / "data");
    EXPECT_EQ(published_server(folder / "data").error().code, ErrorCode::kNotFound) << "not yet";
    ASSERT_TRUE(directory.lock().publish_address("http://127.0.0.1:1234").ok());
    EXPECT_EQ(published_server(folder / "data")->url, "http://127.0.0.1:1234");
    EXPECT_EQ(published_server(folder / "data")->token, directory.token());
  }
  const DataDirectory next(folder / "data");
  EXPECT_EQ(published_server(folder / "data").error().code, ErrorCode::kNotFound)
      << "that was another server";
}

TEST(DataDirectory, AddsUpTheFilesOfAllScansAndUploads) {
  const test::TemporaryFolder folder;
  const DataDirectory directory(folder / "data");
  EXPECT_TRUE(directory.scan_sizes()->empty());
  EXPECT_EQ(*directory.uploads_bytes(), 0u);
  const std::string one = new_scan_id(), two = new_scan_id();
  for (const std::string& id : {one, two}) ASSERT_TRUE(directory.create_scan_folder(id).ok());
  std::ofstream(directory.scan_folder(one) + "/a") << std::string(100, 'x');
  std::filesystem::create_directory(directory.log_folder(one));
  std::ofstream(directory.log_folder(one) + "/segment") << std::string(1000, 'x');
  std::ofstream(directory.scan_folder(two) + "/b") << std::string(23, 'x');
  std::filesystem::create_symlink("/proc/self/exe", directory.scan_folder(two) + "/link");
  EXPECT_THAT(*directory.scan_sizes(),
              testing::UnorderedElementsAre(testing::Pair(one, 1100u), testing::Pair(two, 23u)));
  const std::string upload = new_scan_id();
  std::ofstream(directory.upload_path(upload)) << std::string(1000, 'x');
  ASSERT_TRUE(directory.create_job_folder(upload).ok());
  std::ofstream(directory.job_folder(upload) + "/unpacked") << std::string(5000, 'x');
  EXPECT_EQ(*directory.uploads_bytes(), 1000u);
  EXPECT_EQ(*directory.uploads_bytes(upload), 0u);
  EXPECT_EQ(*directory.uploads_bytes(new_scan_id()), 1000u);
  ASSERT_TRUE(directory.set_aside().discard_scan(one).ok());
  EXPECT_EQ(directory.scan_sizes()->size(), 1u) << "waste does not count";
}

TEST(DataDirectory, WhatJobsHadUnpackedIsOutOfTheWayAtTheNextStart) {
  const test::TemporaryFolder folder;
  const std::string job = new_scan_id();
  {
    const DataDirectory directory(folder / "data");
    ASSERT_TRUE(directory.create_job_folder(job).ok());
    EXPECT_TRUE(directory.set_aside().waste().empty());
  }
  const DataDirectory next(folder / "data");
  EXPECT_FALSE(std::filesystem::exists(next.job_folder(job)));
  ASSERT_EQ(next.set_aside().waste().size(), 1u);
  EXPECT_TRUE(next.set_aside().remove_waste(next.set_aside().waste().front()).ok());
  EXPECT_TRUE(next.set_aside().waste().empty());
}

}  // namespace
}  // namespace hermite::server
