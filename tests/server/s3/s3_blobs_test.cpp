#include "server/s3/s3_blobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/store/scan_id.h"
#include "tests/server/s3/swift.h"
#include "tests/server/store/blobs_contract.h"

namespace hermite::server {
namespace {

using test::Exchange;
using test::S3Proxy;
using test::SwiftServer;
using testing::HasSubstr;

S3Options quick(S3Options options) {
  options.patience.attempts = 3;
  options.patience.connect = std::chrono::milliseconds(1000);
  return options;
}

class S3BlobsTest : public testing::Test {
 protected:
  void SetUp() override { SKIP_WITHOUT_SWIFT(); }

  // Blobs behind a proxy that does `alter`.
  S3Blobs& behind(S3Proxy::Alter alter) {
    proxy_ = std::make_unique<S3Proxy>(SwiftServer::shared()->port(), std::move(alter));
    S3Options options = quick(test::s3_options_at(proxy_->port()));
    blobs_ = std::make_unique<S3Blobs>(options);
    return *blobs_;
  }

  const std::string scan_ = new_scan_id();
  std::unique_ptr<S3Proxy> proxy_;
  std::unique_ptr<S3Blobs> blobs_;
};

bool is_read(const Exchange& exchange) {
  return exchange.request.method() == test::http::verb::get && exchange.request.count("Range") > 0;
}
bool is_put(const Exchange& exchange) { return exchange.request.method() == test::http::verb::put; }

std::string some_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  std::uint32_t state = 1;
  for (char& byte : bytes) byte = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  return bytes;
}

TEST_F(S3BlobsTest, AnObjectOfSeveralBlocksIsReadInPiecesWithOneRequestForEachBlock) {
  S3Blobs& blobs = behind([](Exchange&) {});
  const std::string bytes = some_bytes(kLeastBlock_bytes + 1'000'000);
  ASSERT_TRUE(blobs.put(scan_, "cloud.ply", bytes).ok());
  const int before = proxy_->request_count();
  std::string pieces;
  constexpr std::size_t kPiece = 300'000;  // does not divide a block
  while (pieces.size() < bytes.size()) {
    const Result<std::string> piece = blobs.read(scan_, "cloud.ply", pieces.size(), kPiece);
    ASSERT_TRUE(piece.ok()) << piece.error().message;
    ASSERT_FALSE(piece->empty());
    pieces += *piece;
  }
  EXPECT_TRUE(pieces == bytes);
  EXPECT_LE(proxy_->request_count() - before, 4)
      << "one for what is there, one for each block, one for a piece of both";
  EXPECT_TRUE(*blobs.read(scan_, "cloud.ply", 0, bytes.size()) == bytes) << "at once";
}

TEST_F(S3BlobsTest, ListsMoreThanAPage) {
  S3Options options = test::s3_options_at(SwiftServer::shared()->port());
  options.keys_in_page = 3;
  S3Blobs blobs(options);
  std::vector<BlobInfo> wanted;
  for (int i = 0; i < 7; ++i) {
    wanted.push_back({"b" + std::to_string(i), 1});
    ASSERT_TRUE(blobs.put(scan_, wanted.back().name, "x").ok());
  }
  EXPECT_EQ(*blobs.list(scan_), wanted);
  ASSERT_TRUE(blobs.remove(scan_).ok());
  EXPECT_TRUE(blobs.list(scan_)->empty());
}

TEST_F(S3BlobsTest, AServerThatIsBusyIsAskedAgain) {
  std::atomic<int> busy_count = 0;
  S3Blobs& blobs = behind([&](Exchange& exchange) {
    if (++busy_count % 3 == 0) return;
    exchange.response.result(503);
    exchange.response.body() =
        "<Error><Code>SlowDown</Code><Message>Please reduce your request rate.</Message></Error>";
    exchange.response.prepare_payload();
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "bytes").ok());
  EXPECT_EQ(*blobs.read(scan_, "a", 0, 10), "bytes");
  EXPECT_TRUE(blobs.availability().ok());
}

TEST_F(S3BlobsTest, AServerThatStaysBusyIsAnErrorWithAMessage) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    exchange.response.result(503);
    exchange.response.body() =
        "<Error><Code>SlowDown</Code><Message>Please reduce your request rate.</Message></Error>";
    exchange.response.prepare_payload();
  });
  const Status put = blobs.put(scan_, "a", "bytes");
  ASSERT_FALSE(put.ok());
  EXPECT_EQ(put.error().code, ErrorCode::kIo);
  EXPECT_THAT(put.error().message, HasSubstr("SlowDown"));
  EXPECT_EQ(proxy_->request_count(), 3) << "as often as was allowed";
  EXPECT_FALSE(blobs.availability().ok());
}

TEST_F(S3BlobsTest, WhatIsCutOffIsNeverGivenOut) {
  std::atomic<bool> cut = false;
  S3Blobs& blobs = behind([&](Exchange& exchange) {
    if (cut && is_read(exchange)) exchange.cut_after = 1200;
  });
  ASSERT_TRUE(blobs.put(scan_, "a", some_bytes(5000)).ok());
  cut = true;
  const Result<std::string> bytes = blobs.read(scan_, "a", 0, 5000);
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kIo);
  cut = false;
  EXPECT_EQ(blobs.read(scan_, "a", 0, 5000)->size(), 5000u);
}

// The server says that this is all.
TEST_F(S3BlobsTest, WhatIsShorterThanItWasIsNeverGivenOut) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    if (!is_read(exchange)) return;
    exchange.response.body().resize(100);
    exchange.response.prepare_payload();
  });
  ASSERT_TRUE(blobs.put(scan_, "a", some_bytes(5000)).ok());
  const Result<std::string> bytes = blobs.read(scan_, "a", 10, 20);
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kIo);
  EXPECT_THAT(bytes.error().message, HasSubstr("100 bytes of 5000"));
}

TEST_F(S3BlobsTest, MoreThanWasAskedForIsNotTaken) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    if (!is_read(exchange)) return;
    exchange.response.body().resize(1'000'000);
    exchange.response.prepare_payload();
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "0123").ok());
  EXPECT_EQ(blobs.read(scan_, "a", 0, 4).error().code, ErrorCode::kIo);
}

TEST_F(S3BlobsTest, OtherBytesThanWereStoredAreNeverGivenOut) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    if (is_read(exchange)) exchange.response.body()[2] ^= 1;
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "0123456789").ok());
  for (const std::uint64_t offset : {0u, 5u}) {
    const Result<std::string> bytes = blobs.read(scan_, "a", offset, 4);
    ASSERT_FALSE(bytes.ok()) << "a part that is right lies in a block that is wrong";
    EXPECT_EQ(bytes.error().code, ErrorCode::kIo);
    EXPECT_THAT(bytes.error().message, HasSubstr("checksum"));
  }
}

TEST_F(S3BlobsTest, BytesThatArriveWrongOnceAreAskedForAgain) {
  std::atomic<int> wrong_count = 0;
  S3Blobs& blobs = behind([&](Exchange& exchange) {
    if (is_read(exchange) && wrong_count++ == 0) exchange.response.body()[2] ^= 1;
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "0123456789").ok());
  EXPECT_EQ(*blobs.read(scan_, "a", 0, 10), "0123456789");
}

TEST_F(S3BlobsTest, APutOfWhichOtherBytesAreSaidToBeStoredHasFailed) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    if (is_put(exchange)) exchange.response.set("ETag", "\"00000000000000000000000000000000\"");
  });
  const Status put = blobs.put(scan_, "a", "bytes");
  ASSERT_FALSE(put.ok());
  EXPECT_EQ(put.error().code, ErrorCode::kIo);
  EXPECT_THAT(put.error().message, HasSubstr("other bytes"));
}

// It encrypts with keys of its own, and then an entity tag is no checksum.
TEST_F(S3BlobsTest, AnEncryptingServerHasOtherEntityTags) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    if (!is_put(exchange)) return;
    exchange.response.set("ETag", "\"00000000000000000000000000000000\"");
    exchange.response.set("x-amz-server-side-encryption", "aws:kms");
  });
  EXPECT_TRUE(blobs.put(scan_, "a", "bytes").ok());
}

TEST_F(S3BlobsTest, AConnectionThatIsLostOnceIsMadeAgain) {
  std::atomic<int> count = 0;
  S3Blobs& blobs = behind([&](Exchange& exchange) {
    if (++count % 2 == 1) exchange.cut_after = 0;
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "bytes").ok());
  EXPECT_EQ(*blobs.read(scan_, "a", 0, 10), "bytes");
}

TEST_F(S3BlobsTest, ASlowServerIsGivenUp) {
  std::atomic<bool> slow = false;
  S3Blobs& blobs = behind([&](Exchange& exchange) {
    if (slow) exchange.pause = std::chrono::seconds(30);
  });
  ASSERT_TRUE(blobs.put(scan_, "a", "bytes").ok());
  slow = true;
  S3Options once = quick(test::s3_options_at(proxy_->port()));
  once.patience.attempts = 1;
  once.patience.silence = std::chrono::seconds(1);
  const Result<std::uint64_t> size = S3Blobs(once).size_bytes(scan_, "a");
  ASSERT_FALSE(size.ok());
  EXPECT_EQ(size.error().code, ErrorCode::kIo);
}

TEST_F(S3BlobsTest, NoServerIsAnErrorThatNamesIt) {
  S3Options options = quick(test::s3_options_at(1));
  options.patience.attempts = 1;
  const Status status = S3Blobs(options).check_access();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kIo);
  EXPECT_THAT(status.error().message, HasSubstr("http://127.0.0.1:1"));
}

TEST_F(S3BlobsTest, ACheckOfWhatIsAllowedLeavesNothing) {
  S3Blobs blobs(test::s3_options_at(SwiftServer::shared()->port()));
  const Status status = blobs.check_access();
  EXPECT_TRUE(status.ok()) << status.error().message;
  EXPECT_EQ(blobs.owner().error().code, ErrorCode::kNotFound);
}

TEST_F(S3BlobsTest, SaysWhatIsWrongWithTheAccess) {
  const auto message_of = [](const std::function<void(S3Options&)>& change) {
    S3Options options = quick(test::s3_options_at(SwiftServer::shared()->port()));
    change(options);
    const Status status = S3Blobs(options).check_access();
    return status.ok() ? "nothing is wrong" : status.error().message;
  };
  EXPECT_THAT(message_of([](S3Options& options) { options.bucket = "nowhere"; }),
              HasSubstr("no such bucket"));
  EXPECT_THAT(message_of([](S3Options& options) { options.credentials.secret_key = "other"; }),
              HasSubstr("secret key"));
  EXPECT_THAT(message_of([](S3Options& options) { options.credentials.access_key = "who:me"; }),
              HasSubstr("key"));
  EXPECT_THAT(message_of([](S3Options& options) { options.region = "mars-1"; }),
              HasSubstr("region"));
  EXPECT_THAT(message_of([](S3Options& options) { options.credentials.secret_key = "other"; }),
              testing::Not(HasSubstr("other")));
}

TEST_F(S3BlobsTest, ClocksThatDifferAreNamed) {
  S3Blobs& blobs = behind([](Exchange& exchange) {
    exchange.response.result(403);
    exchange.response.set("Date", "Thu, 01 Jan 2015 00:00:00 GMT");
    exchange.response.body() =
        "<Error><Code>RequestTimeTooSkewed</Code><Message>The difference is too "
        "large.</Message></Error>";
    exchange.response.prepare_payload();
  });
  const Status status = blobs.check_access();
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("clocks"));
  EXPECT_THAT(status.error().message, HasSubstr("2015"));
}

TEST_F(S3BlobsTest, AMissingBucketIsNoMissingBlob) {
  S3Options options = quick(test::s3_options_at(SwiftServer::shared()->port()));
  options.bucket = "nowhere";
  S3Blobs blobs(options);
  EXPECT_EQ(blobs.list(scan_).error().code, ErrorCode::kIo);
  EXPECT_EQ(blobs.remove(scan_, "a").error().code, ErrorCode::kIo);
  EXPECT_EQ(blobs.put(scan_, "a", "x").error().code, ErrorCode::kIo);
}

TEST_F(S3BlobsTest, AnObjectOfAnotherProgramIsNotRead) {
  S3Blobs& blobs =
      behind([](Exchange& exchange) { exchange.response.erase("x-amz-meta-hermite-block"); });
  ASSERT_TRUE(blobs.put(scan_, "a", "bytes").ok());
  const Result<std::string> bytes = blobs.read(scan_, "a", 0, 10);
  ASSERT_FALSE(bytes.ok());
  EXPECT_THAT(bytes.error().message, HasSubstr("not stored by Hermite"));
}

TEST_F(S3BlobsTest, ReplacedByAnotherServerItIsReadAnew) {
  S3Options options = test::s3_options_at(SwiftServer::shared()->port());
  S3Blobs blobs(options), other(options);
  ASSERT_TRUE(blobs.put(scan_, "a", "first").ok());
  EXPECT_EQ(*blobs.read(scan_, "a", 0, 10), "first");
  ASSERT_TRUE(other.put(scan_, "a", "a second one").ok());
  EXPECT_EQ(*blobs.read(scan_, "a", 3, 20), "st")
      << "what is kept in memory: one server writes a prefix";
  S3Blobs third(options);
  EXPECT_EQ(*third.read(scan_, "a", 0, 20), "a second one");
}

TEST_F(S3BlobsTest, EverythingIsListedWithVersions) {
  S3Blobs blobs(test::s3_options_at(SwiftServer::shared()->port()));
  const std::string other = new_scan_id();
  ASSERT_TRUE(blobs.put(scan_, "a", "12").ok());
  ASSERT_TRUE(blobs.put(other, "b", "345").ok());
  ASSERT_TRUE(blobs.set_owner("me").ok());
  std::map<std::string, StoredBlob> found;
  ASSERT_TRUE(blobs
                  .list_all([&](const std::string& scan, const std::string& name,
                                const StoredBlob& blob) { found[scan + name] = blob; })
                  .ok());
  EXPECT_EQ(found, (std::map<std::string, StoredBlob>{{scan_ + "a", *blobs.find(scan_, "a")},
                                                      {other + "b", *blobs.find(other, "b")}}));
}

class S3World {
 public:
  // OpenStack Swift with a single replica says for a moment that an object is not there while it is
  // replaced.
  static constexpr bool kHidesWhatIsReplaced = true;
  static std::string missing() { return SwiftServer::missing(); }
  Blobs& blobs() { return *blobs_; }
  void die() { blobs_ = std::make_unique<S3Blobs>(options_); }

 private:
  const S3Options options_ =
      test::s3_options_at(SwiftServer::shared() ? SwiftServer::shared()->port() : 1);
  std::unique_ptr<Blobs> blobs_ = std::make_unique<S3Blobs>(options_);
};

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(S3, BlobsContract, server::S3World);
}  // namespace hermite::test
