#include "core/archive/whole_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite::archive {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::size_t entries_in(const std::string& path) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(path), fs::directory_iterator()));
}

TEST(WholeFolder, IsThereOnceItIsFinished) {
  const test::TemporaryFolder parent;
  Result<WholeFolder> folder = WholeFolder::make(parent / "a scan/");
  ASSERT_TRUE(folder.ok()) << folder.error().message;
  ASSERT_TRUE(folder->write({"images", "0.txt"}, std::string("zero")).ok());
  EXPECT_FALSE(fs::exists(parent / "a scan"));
  ASSERT_TRUE(folder->finish().ok());
  EXPECT_EQ(fs::file_size(parent / "a scan/images/0.txt"), 4u);
  EXPECT_EQ(entries_in(parent.path()), 1u);
}

TEST(WholeFolder, IsGoneIfItIsNot) {
  const test::TemporaryFolder parent;
  {
    Result<WholeFolder> folder = WholeFolder::make(parent / "scan");
    ASSERT_TRUE(folder.ok()) << folder.error().message;
    ASSERT_TRUE(folder->write({"a"}, std::string("one")).ok());
    WholeFolder moved = *std::move(folder);
    EXPECT_EQ(moved.write({"a"}, std::string("two")).error().code, ErrorCode::kInvalidArgument)
        << "a file of that name is there";
    EXPECT_EQ(entries_in(parent.path()), 1u);
  }
  EXPECT_EQ(entries_in(parent.path()), 0u);
}

TEST(WholeFolder, TakesThePlaceOfAnEmptyFolderOnly) {
  const test::TemporaryFolder parent;
  fs::create_directory(parent / "empty");
  Result<WholeFolder> folder = WholeFolder::make(parent / "empty");
  ASSERT_TRUE(folder.ok()) << folder.error().message;
  ASSERT_TRUE(folder->write({"a"}, std::string("one")).ok());
  ASSERT_TRUE(folder->finish().ok());
  EXPECT_THAT(WholeFolder::make(parent / "empty").error().message,
              HasSubstr("there is something already"));
  EXPECT_THAT(WholeFolder::make(parent / "empty/a").error().message,
              HasSubstr("there is something already"));
  EXPECT_EQ(WholeFolder::make(parent / "no/such").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(WholeFolder::make("").error().code, ErrorCode::kInvalidArgument);
}

TEST(WholeFolder, DoesNotCoverWhatCameInTheMeantime) {
  const test::TemporaryFolder parent;
  {
    Result<WholeFolder> folder = WholeFolder::make(parent / "scan");
    ASSERT_TRUE(folder.ok()) << folder.error().message;
    std::ofstream(parent / "scan") << "mine";
    EXPECT_EQ(folder->finish().error().code, ErrorCode::kInvalidArgument);
  }
  EXPECT_EQ(fs::file_size(parent / "scan"), 4u);
  EXPECT_EQ(entries_in(parent.path()), 1u);
}

}  // namespace
}  // namespace hermite::archive
