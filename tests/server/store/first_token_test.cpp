#include "server/store/first_token.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "core/base/result.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::first_token_test {
namespace {

TEST(FirstToken, IsMadeOnceAndIsPrivate) {
  const test::TemporaryFolder folder;
  const std::string token = read_or_create_first_token(folder / "token");
  EXPECT_EQ(token.size(), 64u);
  chmod((folder / "token").c_str(), 0644);
  EXPECT_EQ(read_or_create_first_token(folder / "token"), token);
  struct stat status {};
  ASSERT_EQ(stat((folder / "token").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST(FirstToken, IsNotMadeOverAFileThatHoldsNone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "token") << "no token\n";
  EXPECT_THROW(read_or_create_first_token(folder / "token"), SetupError);
  EXPECT_EQ(std::filesystem::file_size(folder / "token"), 9u);
}

TEST(FirstToken, IsNotMadeOfAnUnfinishedOne) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "token.new") << "half of i";
  EXPECT_EQ(read_or_create_first_token(folder / "token").size(), 64u);
  EXPECT_FALSE(std::filesystem::exists(folder / "token.new"));
}

}  // namespace
}  // namespace hermite::server::first_token_test
