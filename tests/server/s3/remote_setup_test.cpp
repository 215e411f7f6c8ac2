#include "server/s3/remote_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/server/s3/swift.h"

namespace hermite::server {
namespace {

using test::SwiftServer;
using testing::HasSubstr;

class RemoteSetupTest : public testing::Test {
 protected:
  void SetUp() override { SKIP_WITHOUT_SWIFT(); }
  const test::TemporaryFolder data_, other_;
};

TEST_F(RemoteSetupTest, APrefixBelongsToOneFolder) {
  const S3Options options = test::s3_options_at(SwiftServer::shared()->port());
  S3Blobs s3(options);
  ASSERT_TRUE(join_to_s3(data_.path(), s3).ok());
  EXPECT_TRUE(join_to_s3(data_.path(), s3).ok()) << "at every start";
  EXPECT_EQ(join_to_s3(other_.path(), s3).error().code, ErrorCode::kBusy);
  EXPECT_EQ(**blobs_at(data_.path()), s3.address());
  EXPECT_FALSE(*blobs_at(other_.path()));
  ASSERT_TRUE(leave_s3(data_.path()).ok());
  ASSERT_TRUE(give_up_prefix(data_.path(), s3).ok());
  EXPECT_TRUE(join_to_s3(other_.path(), s3).ok()) << "now it is free";
}

TEST_F(RemoteSetupTest, ARestoredFolderGoesOn) {
  S3Blobs s3(test::s3_options_at(SwiftServer::shared()->port()));
  ASSERT_TRUE(join_to_s3(data_.path(), s3).ok());
  std::filesystem::copy_file(data_ / "blobs-at", other_ / "blobs-at");
  EXPECT_TRUE(join_to_s3(other_.path(), s3).ok());
}

TEST_F(RemoteSetupTest, AServerStartsOnlyWhereItsResultsAre) {
  S3Blobs s3(test::s3_options_at(SwiftServer::shared()->port()));
  const std::string at = s3.address();
  EXPECT_TRUE(check_place(data_.path(), "", true).ok());
  EXPECT_TRUE(check_place(data_.path(), at, false).ok());
  EXPECT_THAT(check_place(data_.path(), at, true).error().message, HasSubstr("hermite migrate"));
  ASSERT_TRUE(join_to_s3(data_.path(), s3).ok());
  EXPECT_TRUE(check_place(data_.path(), at, true).ok())
      << "a checkpoint, or what a migration has left";
  EXPECT_THAT(check_place(data_.path(), "", false).error().message, HasSubstr("--blobs " + at));
  EXPECT_FALSE(check_place(data_.path(), "s3://scans/elsewhere", false).ok());
  std::ofstream(data_ / "blobs-at") << "nonsense";
  EXPECT_EQ(check_place(data_.path(), at, false).error().code, ErrorCode::kCorruptData);
}

TEST(S3Settings, NameWhatIsWrong) {
  S3Settings settings{"s3://scans/a", "https://s3.example.org", "us-east-1", "path", "", "/none",
                      false};
  EXPECT_THAT(s3_options(settings).error().message, HasSubstr("s3-credentials"));
  settings.ca_file = "/none";
  EXPECT_THAT(s3_options(settings).error().message, HasSubstr("s3-ca"));
  settings.addressing = "other";
  EXPECT_THAT(s3_options(settings).error().message, HasSubstr("s3-addressing"));
  settings.endpoint = "nonsense";
  EXPECT_THAT(s3_options(settings).error().message, HasSubstr("s3-endpoint"));
  settings.blobs = "nonsense";
  EXPECT_THAT(s3_options(settings).error().message, HasSubstr("blobs"));
}

}  // namespace
}  // namespace hermite::server
