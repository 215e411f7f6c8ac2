#include "server/store/upload_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>

#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

std::string text_of(const std::string& path) {
  const std::vector<std::uint8_t> bytes = test::file_bytes(path);
  return {bytes.begin(), bytes.end()};
}

TEST(UploadFile, GrowsFromTheEndAndCanBeCut) {
  const test::TemporaryFolder folder;
  {
    Result<UploadFile> file = UploadFile::create(folder / "a");
    ASSERT_TRUE(file.ok());
    EXPECT_TRUE(file->append("hello ").ok());
    EXPECT_TRUE(file->append("world").ok());
    EXPECT_TRUE(file->sync().ok());
    EXPECT_EQ(file->size_bytes(), 11);
  }
  Result<UploadFile> again = UploadFile::open(folder / "a");
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->size_bytes(), 11);
  EXPECT_TRUE(again->cut(6).ok());
  EXPECT_TRUE(again->append("all").ok());
  EXPECT_EQ(text_of(folder / "a"), "hello all");
  EXPECT_EQ(*upload_size_bytes(folder / "a"), 9);
}

TEST(UploadFile, IsPrivateAndTakesNoOthersPlace) {
  const test::TemporaryFolder folder;
  { ASSERT_TRUE(UploadFile::create(folder / "a").ok()); }
  struct stat status {};
  ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_FALSE(UploadFile::create(folder / "a").ok());
  std::filesystem::create_symlink(folder / "a", folder / "link");
  EXPECT_FALSE(UploadFile::open(folder / "link").ok());
  EXPECT_FALSE(upload_size_bytes(folder / "link").ok());
}

TEST(UploadFile, OneThatIsGoneIsNotFound) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(UploadFile::open(folder / "a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(upload_size_bytes(folder / "a").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(remove_upload_file(folder / "a").ok());
}

TEST(UploadFile, AFullDiskIsSaidAndWhatWentInIsCounted) {
  const test::TemporaryFolder folder;
  Result<UploadFile> file = UploadFile::create(folder / "a");
  ASSERT_TRUE(file.ok());
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const Status written = file->append(std::string(10'000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::kIo);
  EXPECT_EQ(file->size_bytes(), 4096);
}

}  // namespace
}  // namespace hermite::server
