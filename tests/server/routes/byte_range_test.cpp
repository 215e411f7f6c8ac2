// Ranges as RFC 9110 has them. That they come through a real connection: http_connection_test.cpp.
#include "server/routes/byte_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::HasSubstr;

std::string header_of(const HttpAnswer& answer, const std::string& name) {
  for (const auto& [given, value] : answer.headers)
    if (given == name) return value;
  return {};
}

HttpAnswer ask(HttpHeaders headers, const std::string& method = "GET") {
  HttpAnswer stored;
  stored.stored = StoredBody{10, {}};
  return as_asked(std::move(stored), "v1", {method, "/", "", "", "", {}, std::move(headers)});
}

// "first+count", or the status where there is no part.
std::string part(const std::string& range) {
  const HttpAnswer answer = ask({{"Range", range}});
  if (answer.status != 206) return std::to_string(answer.status);
  return std::to_string(answer.stored->first_byte) + "+" +
         std::to_string(answer.stored->size_bytes) + " " + header_of(answer, "Content-Range");
}

TEST(ByteRange, IsWhatIsAskedForAsFarAsItIsThere) {
  EXPECT_EQ(part("bytes=0-3"), "0+4 bytes 0-3/10");
  EXPECT_EQ(part("bytes=4-"), "4+6 bytes 4-9/10");
  EXPECT_EQ(part("bytes=9-9"), "9+1 bytes 9-9/10");
  EXPECT_EQ(part("bytes=8-99"), "8+2 bytes 8-9/10");
  EXPECT_EQ(part("bytes=-3"), "7+3 bytes 7-9/10");
  EXPECT_EQ(part("bytes=-99"), "0+10 bytes 0-9/10");
}

TEST(ByteRange, NothingOfItIsSaidToBeSo) {
  for (const char* range :
       {"bytes=10-", "bytes=10-12", "bytes=-0", "bytes=18446744073709551615-"}) {
    const HttpAnswer answer = ask({{"range", range}});
    EXPECT_EQ(answer.status, 416) << range;
    EXPECT_EQ(header_of(answer, "Content-Range"), "bytes */10");
    EXPECT_THAT(answer.body, HasSubstr("the file has 10 bytes"));
    EXPECT_FALSE(answer.stored);
  }
}

TEST(ByteRange, WhatMakesNoSenseIsAnsweredWithTheWhole) {
  for (const char* range :
       {"", "bytes=", "bytes=-", "bytes=5-4", "bytes=a-b", "bytes=1-2,4-5", "bytes=-1-2",
        "bytes= 1-2", "lines=1-2", "bytes=0-18446744073709551616"})
    EXPECT_EQ(part(range), "200") << range;
  EXPECT_EQ(ask({{"Range", "bytes=0-1"}, {"Range", "bytes=2-3"}}).status, 200);
}

TEST(ByteRange, AnotherVersionIsSentFromItsBeginning) {
  const HttpAnswer whole = ask({});
  EXPECT_EQ(header_of(whole, "ETag"), "\"v1\"");
  EXPECT_EQ(header_of(whole, "Accept-Ranges"), "bytes");
  EXPECT_EQ(ask({{"Range", "bytes=1-"}, {"If-Range", "\"v1\""}}).status, 206);
  EXPECT_EQ(ask({{"Range", "bytes=1-"}, {"If-Range", "\"v0\""}}).status, 200);
  EXPECT_EQ(ask({{"Range", "bytes=1-"}, {"If-Range", "W/\"v1\""}}).status, 200);
  EXPECT_EQ(ask({{"Range", "bytes=1-"}, {"If-Range", "Wed, 21 Oct 2015 07:28:00 GMT"}}).status,
            200);
}

TEST(ByteRange, IsOfAGetAlone) { EXPECT_EQ(ask({{"Range", "bytes=1-"}}, "HEAD").status, 200); }

TEST(ByteRange, AnAnswerWithoutAFileHasNone) {
  HttpAnswer whole;
  whole.body = "0123456789";
  const HttpAnswer answer =
      as_asked(whole, "v1", {"GET", "/", "", "", "", {}, {{"Range", "bytes=1-"}}});
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, whole.body);
  EXPECT_TRUE(answer.headers.empty());
}

}  // namespace
}  // namespace hermite::server
