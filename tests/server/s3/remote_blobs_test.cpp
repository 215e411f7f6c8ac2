#include "server/s3/remote_blobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/server/s3/swift.h"
#include "tests/server/store/blobs_contract.h"

namespace hermite::server {
namespace {

using test::SwiftServer;
using testing::HasSubstr;

class RemoteWorld {
 public:
  static constexpr bool kHidesWhatIsReplaced = false;
  static std::string missing() { return SwiftServer::missing(); }
  RemoteWorld() : RemoteWorld(SwiftServer::shared() ? SwiftServer::shared()->port() : 1) {}
  explicit RemoteWorld(int port) : options_(test::s3_options_at(port)) {
    options_.patience.attempts = 2;
    options_.patience.silence = std::chrono::seconds(2);
    die();
  }
  Blobs& blobs() { return *remote_; }
  RemoteBlobs& remote() { return *remote_; }
  const S3Options& options() const { return options_; }
  const test::TemporaryFolder& folder() const { return folder_; }
  void die() {
    remote_.reset();
    remote_ = std::make_unique<RemoteBlobs>(
        options_, LocalBlobs{files_, {"checkpoint.bin"}, folder_ / "removals"});
    loaded_ = remote_->load();
  }
  const Status& loaded() const { return loaded_; }

 private:
  S3Options options_;
  const test::TemporaryFolder folder_;
  FileBlobs files_{folder_.path()};
  std::unique_ptr<RemoteBlobs> remote_;
  Status loaded_ = Done{};
};

bool comes_true(const std::function<bool()>& what) {
  for (int i = 0; i < 1000; ++i) {
    if (what()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class RemoteBlobsTest : public testing::Test {
 protected:
  void SetUp() override { SKIP_WITHOUT_SWIFT(); }
  const std::string scan_ = new_scan_id();
};

TEST_F(RemoteBlobsTest, ACheckpointStaysOnTheOwnDisk) {
  RemoteWorld world;
  ASSERT_TRUE(world.blobs().put(scan_, "checkpoint.bin", "state").ok());
  ASSERT_TRUE(world.blobs().put(scan_, "cloud.ply", "points").ok());
  EXPECT_TRUE(std::filesystem::exists(world.folder() / (scan_ + "/checkpoint.bin")));
  EXPECT_FALSE(std::filesystem::exists(world.folder() / (scan_ + "/cloud.ply")));
  EXPECT_EQ(world.blobs().list(scan_)->size(), 2u);
  EXPECT_EQ(S3Blobs(world.options()).list(scan_)->size(), 1u);
  std::map<std::string, std::uint64_t> sizes;
  world.remote().add_sizes(sizes);
  EXPECT_EQ(sizes, (std::map<std::string, std::uint64_t>{{scan_, 6}}));
  ASSERT_TRUE(world.blobs().remove(scan_).ok());
  EXPECT_FALSE(std::filesystem::exists(world.folder() / (scan_ + "/checkpoint.bin")));
}

TEST_F(RemoteBlobsTest, WhatIsRemovedGoesFromTheBucketSoon) {
  RemoteWorld world;
  ASSERT_TRUE(world.blobs().put(scan_, "a", "x").ok());
  ASSERT_TRUE(world.blobs().remove(scan_).ok());
  EXPECT_TRUE(comes_true([&] { return S3Blobs(world.options()).list(scan_)->empty(); }));
  EXPECT_TRUE(comes_true([&] { return world.remote().removal_count() == 0; }));
}

// One that is its own, since it is killed.
TEST_F(RemoteBlobsTest, WhileS3IsAwayNothingIsForgotten) {
  SwiftServer server;
  RemoteWorld world(server.port());
  ASSERT_TRUE(world.loaded().ok()) << world.loaded().error().message;
  for (const char* name : {"removed", "again", "kept"})
    ASSERT_TRUE(world.blobs().put(scan_, name, name).ok());
  server.kill();
  ASSERT_TRUE(world.blobs().remove(scan_, "removed").ok()) << "it is noted";
  ASSERT_TRUE(world.blobs().remove(scan_, "again").ok());
  EXPECT_EQ(world.blobs().size_bytes(scan_, "removed").error().code, ErrorCode::kNotFound)
      << "at once";
  EXPECT_EQ(*world.blobs().size_bytes(scan_, "kept"), 4u) << "this is known without asking";
  EXPECT_EQ(world.blobs().read(scan_, "kept", 0, 4).error().code, ErrorCode::kIo)
      << "no missing blob";
  EXPECT_EQ(world.blobs().put(scan_, "new", "x").error().code, ErrorCode::kIo);
  EXPECT_THAT(world.blobs().availability().error().message, HasSubstr("127.0.0.1"));
  world.die();
  EXPECT_FALSE(world.loaded().ok()) << "a server does not start without knowing what there is";
  server.start();
  world.die();
  ASSERT_TRUE(world.loaded().ok()) << world.loaded().error().message;
  EXPECT_EQ(world.blobs().size_bytes(scan_, "removed").error().code, ErrorCode::kNotFound)
      << "also to the next one";
  ASSERT_TRUE(world.blobs().put(scan_, "again", "new").ok());
  EXPECT_TRUE(comes_true([&] { return world.remote().removal_count() == 0; }));
  EXPECT_EQ(*world.blobs().read(scan_, "again", 0, 10), "new")
      << "what was put again is not removed any more";
  EXPECT_THAT(*S3Blobs(world.options()).list(scan_),
              testing::ElementsAre(BlobInfo{"again", 3}, BlobInfo{"kept", 4}));
}

TEST_F(RemoteBlobsTest, ItIsNoticedThatS3AnswersAgain) {
  SwiftServer server;
  RemoteWorld world(server.port());
  server.kill();
  EXPECT_FALSE(world.blobs().put(scan_, "a", "x").ok());
  EXPECT_FALSE(world.blobs().availability().ok());
  server.start();
  EXPECT_TRUE(comes_true([&] { return world.blobs().availability().ok(); })) << "by itself";
}

// The answer to a put is lost, but not what was put.
TEST_F(RemoteBlobsTest, AfterAPutWithoutAnAnswerItAsksWhatIsThere) {
  std::atomic<bool> lost = false;
  test::S3Proxy proxy(SwiftServer::shared()->port(), [&](test::Exchange& exchange) {
    if (lost && exchange.request.method() == test::http::verb::put) exchange.cut_after = 0;
  });
  RemoteWorld world(proxy.port());
  lost = true;
  EXPECT_FALSE(world.blobs().put(scan_, "a", "bytes").ok());
  EXPECT_TRUE(comes_true([&] { return world.blobs().size_bytes(scan_, "a").ok(); }));
}

TEST_F(RemoteBlobsTest, ABucketThatIsEmptiedByOthersIsNoMissingBlob) {
  RemoteWorld world;
  ASSERT_TRUE(world.blobs().put(scan_, "a", "x").ok());
  ASSERT_TRUE(S3Blobs(world.options()).remove(scan_).ok());
  EXPECT_EQ(world.blobs().read(scan_, "a", 0, 1).error().code, ErrorCode::kIo);
}

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Remote, BlobsContract, server::RemoteWorld);
}  // namespace hermite::test
