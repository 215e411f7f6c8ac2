#include "server/store/disk_space.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

TEST(FreeBytes, OfAFolderAndOfNone) {
  const test::TemporaryFolder folder;
  EXPECT_GT(*free_bytes(folder.path()), 0u);
  EXPECT_EQ(free_bytes(folder / "none").error().code, ErrorCode::kIo);
}

TEST(DiskSpace, FitsIntoTheDisk) {
  const test::TemporaryFolder folder;
  EXPECT_LE(*free_bytes(folder.path()), *disk_capacity_bytes(folder.path()));
  EXPECT_EQ(disk_capacity_bytes(folder / "none").error().code, ErrorCode::kIo);
  const Result<Inodes> inodes = disk_inodes(folder.path());
  ASSERT_TRUE(inodes.ok());
  EXPECT_GT(inodes->free, 0u);
  EXPECT_LE(inodes->free, inodes->all);
  EXPECT_EQ(disk_inodes(folder / "none").error().code, ErrorCode::kIo);
}

TEST(CheckTakesFiles, LeavesNothingBehind) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(check_takes_files(folder.path()).ok());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_EQ(check_takes_files(folder / "none").error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace hermite::server
