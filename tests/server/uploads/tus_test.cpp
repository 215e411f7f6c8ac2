#include "server/uploads/tus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::HasSubstr;

constexpr const char* kSha1OfNothing = "sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk=";

std::string message_of(const HttpHeaders& headers) {
  const Result<TusHeaders> parsed = parse_tus_headers(headers);
  return parsed.ok() ? "well" : parsed.error().message;
}

TEST(Tus, ReadsTheHeadersWhateverTheirCase) {
  const Result<TusHeaders> parsed =
      parse_tus_headers({{"tus-resumable", "1.0.0"},
                         {"UPLOAD-OFFSET", "70"},
                         {"Upload-Length", "100"},
                         {"Upload-Checksum", kSha1OfNothing},
                         {"Content-Type", "application/offset+octet-stream"},
                         {"Upload-Metadata", "filename cm9vbS50YXI=, title,camera ZnIx"}});
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  EXPECT_EQ(parsed->version, "1.0.0");
  EXPECT_EQ(parsed->offset_bytes, 70);
  EXPECT_EQ(parsed->length_bytes, 100);
  EXPECT_FALSE(parsed->length_follows);
  EXPECT_TRUE(parsed->is_piece);
  ASSERT_TRUE(parsed->checksum);
  EXPECT_EQ(parsed->checksum->digest.size(), 20u);
  const auto metadata = parse_upload_metadata(parsed->metadata);
  ASSERT_TRUE(metadata.ok());
  EXPECT_EQ(metadata->at("filename"), "room.tar");
  EXPECT_EQ(metadata->at("title"), "");
  EXPECT_EQ(metadata->at("camera"), "fr1");
}

TEST(Tus, NothingIsSaidByNoHeaders) {
  const Result<TusHeaders> parsed = parse_tus_headers({});
  ASSERT_TRUE(parsed.ok());
  EXPECT_TRUE(parsed->version.empty());
  EXPECT_FALSE(parsed->length_bytes || parsed->offset_bytes || parsed->checksum ||
               parsed->length_follows || parsed->is_piece);
}

TEST(Tus, NumbersThatAreNoneAreNamed) {
  for (const char* text : {"", "-1", "-0", "+1", "1.5", "0x10", " 1", "1 ", "9007199254740993",
                           "99999999999999999999999", "NaN", "1,2"})
    EXPECT_THAT(message_of({{"Upload-Length", text}}),
                HasSubstr("Upload-Length is no whole number from 0 to"))
        << '"' << text << '"';
  EXPECT_EQ(message_of({{"Upload-Length", "9007199254740992"}}), "well");
  EXPECT_THAT(message_of({{"Upload-Offset", "1"}, {"upload-offset", "1"}}),
              HasSubstr("Upload-Offset is there twice"));
}

TEST(Tus, ADeferredLengthIsOneAndAlone) {
  EXPECT_EQ(message_of({{"Upload-Defer-Length", "1"}}), "well");
  EXPECT_THAT(message_of({{"Upload-Defer-Length", "true"}}), HasSubstr("is not 1"));
  EXPECT_THAT(message_of({{"Upload-Defer-Length", "1"}, {"Upload-Length", "5"}}),
              HasSubstr("do not go together"));
}

TEST(Tus, ChecksumsThatCannotBeAreNamed) {
  EXPECT_THAT(message_of({{"Upload-Checksum", "md5 1B2M2Y8AsgTpgAmY7PhCfg=="}}),
              HasSubstr("another algorithm"));
  EXPECT_EQ(parse_tus_headers({{"Upload-Checksum", "md5 1B2M2Y8AsgTpgAmY7PhCfg=="}}).error().code,
            ErrorCode::kUnsupported);
  EXPECT_THAT(message_of({{"Upload-Checksum", "sha1"}}), HasSubstr("not ALGORITHM BASE64"));
  EXPECT_THAT(message_of({{"Upload-Checksum", "sha1 abc"}}), HasSubstr("no base64 of 20 bytes"));
  EXPECT_THAT(message_of({{"Upload-Checksum", "sha256 2jmj7l5rSw0yVb/vlWAYkK/YBwk="}}),
              HasSubstr("no base64 of 32 bytes"));
}

TEST(Tus, MetadataThatCannotBeIsNamed) {
  EXPECT_THAT(message_of({{"Upload-Metadata", "a Zg==,a Zg=="}}), HasSubstr("the key a twice"));
  EXPECT_THAT(message_of({{"Upload-Metadata", "a Zg"}}), HasSubstr("value of a that is no base64"));
  EXPECT_THAT(message_of({{"Upload-Metadata", "a Zg==,,b Zg=="}}), HasSubstr("empty key"));
  EXPECT_THAT(message_of({{"Upload-Metadata", "\x01 Zg=="}}), HasSubstr("no printable ASCII"));
  EXPECT_THAT(message_of({{"Upload-Metadata", std::string(5000, 'a')}}),
              HasSubstr("has 5000 bytes, allowed are 4096"));
  std::string many;
  for (char key = 'a'; key <= 'z'; ++key) many += std::string(many.empty() ? "" : ",") + key;
  EXPECT_THAT(message_of({{"Upload-Metadata", many}}), HasSubstr("more than 16 keys"));
}

TEST(Tus, PercentsAreDecodedWhereTheyMeanSomething) {
  EXPECT_EQ(decode_percent("my%20room%2etar"), "my room.tar");
  EXPECT_EQ(decode_percent("100%"), "100%");
  EXPECT_EQ(decode_percent("%zz%4"), "%zz%4");
}

}  // namespace
}  // namespace hermite::server
