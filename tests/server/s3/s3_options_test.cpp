#include "server/s3/s3_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(S3Location, HasABucketAndAPrefix) {
  EXPECT_EQ(parse_s3_location("s3://scans")->prefix, "");
  EXPECT_EQ(parse_s3_location("s3://scans/")->prefix, "");
  EXPECT_EQ(parse_s3_location("s3://my.scans-1/a/B_c")->bucket, "my.scans-1");
  EXPECT_EQ(parse_s3_location("s3://scans/a/B_c/")->prefix, "a/B_c/");
  for (const char* text : {"s3://scans", "s3://scans/a/B_c"})
    EXPECT_EQ(text_of(*parse_s3_location(text)), text);
}

TEST(S3Location, IsNothingElse) {
  for (const char* text :
       {"", "s3://", "s3://ab", "s3:/scans", "https://scans", "s3://Scans", "s3://sc..ans",
        "s3://-scans", "s3://scans//a", "s3://scans/../a", "s3://scans/./a", "s3://scans/a b",
        "s3://scans/%2e", "s3://user@scans", "s3://scans?x"})
    EXPECT_EQ(parse_s3_location(text).error().code, ErrorCode::kInvalidArgument) << text;
  EXPECT_FALSE(parse_s3_location("s3://scans/" + std::string(201, 'a')).ok());
}

TEST(S3Endpoint, IsEncryptedUnlessItIsHere) {
  EXPECT_EQ(*checked_s3_endpoint("", "eu-central-1", false),
            "https://s3.eu-central-1.amazonaws.com");
  EXPECT_TRUE(checked_s3_endpoint("https://s3.example.org:9000", "us-east-1", false).ok());
  EXPECT_TRUE(checked_s3_endpoint("http://127.0.0.1:9000", "us-east-1", false).ok());
  EXPECT_THAT(checked_s3_endpoint("http://s3.example.org", "us-east-1", false).error().message,
              HasSubstr("not encrypted"));
  EXPECT_THAT(
      checked_s3_endpoint("http://localhost.example.org", "us-east-1", false).error().message,
      HasSubstr("not encrypted"));
  EXPECT_TRUE(checked_s3_endpoint("http://s3.example.org", "us-east-1", true).ok());
  for (const char* text : {"s3.example.org", "https://", "https://a/b", "https://key:secret@a",
                           "ftp://a", "https://a?b"})
    EXPECT_FALSE(checked_s3_endpoint(text, "us-east-1", true).ok()) << text;
  EXPECT_FALSE(checked_s3_endpoint("", "EU", false).ok());
}

class S3CredentialsTest : public testing::Test {
 protected:
  std::string file(const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_ / "key";
    std::ofstream(path) << text;
    EXPECT_EQ(chmod(path.c_str(), mode), 0);
    return path;
  }
  const test::TemporaryFolder folder_;
};

TEST_F(S3CredentialsTest, AreReadFromAPrivateFile) {
  const Result<S3Credentials> read = read_s3_credentials(
      file("[default]\naws_access_key_id = AKIA1\naws_secret_access_key=abc/+=\nregion = "
           "x\naws_session_token = t\n"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->access_key, "AKIA1");
  EXPECT_EQ(read->secret_key, "abc/+=");
  EXPECT_EQ(read->session_token, "t");
}

TEST_F(S3CredentialsTest, MayNotBeReadByOthers) {
  const std::string text = "aws_access_key_id = AKIA1\naws_secret_access_key = secret\n";
  for (const mode_t mode : {0644u, 0640u, 0604u}) {
    const Result<S3Credentials> read = read_s3_credentials(file(text, mode));
    ASSERT_FALSE(read.ok());
    EXPECT_THAT(read.error().message, HasSubstr("chmod 600"));
  }
}

TEST_F(S3CredentialsTest, ThatAreIncompleteAreNamedAndNotTold) {
  const std::string message =
      read_s3_credentials(file("aws_secret_access_key = verysecret\n")).error().message;
  EXPECT_THAT(message, HasSubstr("aws_access_key_id"));
  EXPECT_THAT(message, testing::Not(HasSubstr("verysecret")));
  EXPECT_FALSE(
      read_s3_credentials(file("aws_access_key_id = a\naws_secret_access_key = two words\n")).ok());
  EXPECT_EQ(read_s3_credentials(folder_ / "none").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(read_s3_credentials(folder_.path()).ok());
}

TEST_F(S3CredentialsTest, ComeFromTheEnvironmentWithoutAFile) {
  unsetenv("AWS_SECRET_ACCESS_KEY");
  setenv("AWS_ACCESS_KEY_ID", "a", 1);
  EXPECT_THAT(read_s3_credentials("").error().message, HasSubstr("AWS_SECRET_ACCESS_KEY"));
  setenv("AWS_SECRET_ACCESS_KEY", "b", 1);
  EXPECT_EQ(read_s3_credentials("")->secret_key, "b");
  unsetenv("AWS_ACCESS_KEY_ID");
  unsetenv("AWS_SECRET_ACCESS_KEY");
}

}  // namespace
}  // namespace hermite::server
