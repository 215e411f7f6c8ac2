#include "server/store/folder_lock.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "tests/support/temporary_folder.h"

namespace hermite::server::folder_lock_test {
namespace {

const std::string kToken(64, 'a');

std::optional<ErrorCode> refusal(const std::string& folder) {
  try {
    const FolderLock lock(folder);
  } catch (const SetupError& error) {
    return error.error().code;
  }
  return std::nullopt;
}

TEST(FolderLock, IsHeldByOneUntilItGoes) {
  const test::TemporaryFolder folder;
  {
    const FolderLock lock(folder.path());
    EXPECT_EQ(refusal(folder.path()), ErrorCode::kBusy);
    ASSERT_TRUE(std::filesystem::remove(folder / "lock"));
    EXPECT_EQ(refusal(folder.path()), ErrorCode::kBusy) << "the folder itself is locked, too";
  }
  EXPECT_EQ(refusal(folder.path()), std::nullopt);
  EXPECT_EQ(refusal(folder / "none"), ErrorCode::kIo);
}

TEST(FolderLock, PublishesTheAddressOfItsServerOnly) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "token") << kToken << "\n";
  {
    const FolderLock lock(folder.path());
    EXPECT_EQ(published_server(folder.path()).error().code, ErrorCode::kNotFound);
    ASSERT_TRUE(lock.publish_address("http://127.0.0.1:1234").ok());
    const Result<PublishedServer> published = published_server(folder.path());
    ASSERT_TRUE(published.ok());
    EXPECT_EQ(published->url, "http://127.0.0.1:1234");
    EXPECT_EQ(published->token, kToken);
    std::ofstream(folder / "token") << "no token";
    EXPECT_EQ(published_server(folder.path()).error().code, ErrorCode::kNotFound);
  }
  std::ofstream(folder / "token") << kToken << "\n";
  const FolderLock next(folder.path());
  EXPECT_EQ(published_server(folder.path()).error().code, ErrorCode::kNotFound)
      << "that was another server";
}

}  // namespace
}  // namespace hermite::server::folder_lock_test
