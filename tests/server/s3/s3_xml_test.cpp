#include "server/s3/s3_xml.h"

#include <gtest/gtest.h>

namespace hermite::server {
namespace {

std::string page(const std::string& inside) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ListBucketResult "
         "xmlns=\"http://s3.amazonaws.com/doc/2006-03-01/\">" +
         inside + "</ListBucketResult>";
}

TEST(S3Page, HasObjectsAndTheTokenOfTheNextOne) {
  const Result<S3Page> read = parse_s3_page(
      page("<IsTruncated>true</IsTruncated><NextContinuationToken>a/b==</NextContinuationToken>"
           "<Contents><Key>p/a</Key><ETag>&quot;abc-2&quot;</ETag><Size>5000000000</Size></"
           "Contents><Contents><Key>p/b</"
           "Key><Size>0</Size></Contents>"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->next, "a/b==");
  ASSERT_EQ(read->objects.size(), 2u);
  EXPECT_EQ(read->objects[0].key, "p/a");
  EXPECT_EQ(read->objects[0].etag, "abc-2");
  EXPECT_EQ(read->objects[0].size_bytes, 5'000'000'000u);
}

TEST(S3Page, OfABadServerIsRefused) {
  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  for (const std::string& text :
       {std::string(), std::string("<html>"), std::string("{}"), deep, page(""),
        page("<IsTruncated>true</IsTruncated>"),
        page("<IsTruncated>false</IsTruncated><Contents><Key>a</Key></Contents>"),
        page("<IsTruncated>false</IsTruncated><Contents><Key>a</Key><Size>-1</Size></Contents>"),
        page("<IsTruncated>false</IsTruncated><Contents><Size>1</Size></Contents>"),
        page("<IsTruncated>false</IsTruncated>").substr(0, 90)})
    EXPECT_EQ(parse_s3_page(text).error().code, ErrorCode::kCorruptData) << text.substr(0, 200);
}

TEST(S3ErrorBody, IsReadWhereThereIsOne) {
  const S3ErrorBody error = parse_s3_error(
      "<?xml version=\"1.0\"?><Error><Code>NoSuchKey</Code><Message>None &amp; "
      "nothing</Message></Error>");
  EXPECT_EQ(error.code, "NoSuchKey");
  EXPECT_EQ(error.message, "None & nothing");
  for (const char* text : {"", "<html><body>502</body></html>", "<Error>", "<Error/>"})
    EXPECT_EQ(parse_s3_error(text).code, "") << text;
}

}  // namespace
}  // namespace hermite::server
