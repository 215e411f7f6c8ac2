#include "server/s3/migrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "server/s3/remote_blobs.h"
#include "server/s3/remote_setup.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/server/s3/swift.h"

namespace hermite::server {
namespace {

using test::SwiftServer;
using testing::ElementsAre;

class MigrateTest : public testing::Test {
 protected:
  void SetUp() override {
    SKIP_WITHOUT_SWIFT();
    options_ = test::s3_options_at(SwiftServer::shared()->port());
    options_.patience.attempts = 1;
    s3_ = std::make_unique<S3Blobs>(options_);
    std::filesystem::create_directory(data_ / "scans");
    for (const char* name : {"cloud.ply", "report.json", "checkpoint.bin"})
      ASSERT_TRUE(files_.put(scan_, name, name).ok());
    ASSERT_TRUE(files_.put(other_, "empty", "").ok());
  }
  Migration migration(S3Blobs& s3) {
    return {data_.path(), files_, s3, {scan_, other_}, {"checkpoint.bin"}, data_ / "blob-removals"};
  }

  const test::TemporaryFolder data_;
  FileBlobs files_{data_ / "scans"};
  const std::string scan_ = new_scan_id(), other_ = new_scan_id();
  S3Options options_;
  std::unique_ptr<S3Blobs> s3_;
};

TEST_F(MigrateTest, ThereAndBackNothingHasChanged) {
  const Result<MigrationCounts> there = migrate_to_s3(migration(*s3_));
  ASSERT_TRUE(there.ok()) << there.error().message;
  EXPECT_EQ(there->blob_count, 3u);
  EXPECT_EQ(there->copied_count, 3u);
  EXPECT_THAT(*files_.list(scan_), ElementsAre(BlobInfo{"checkpoint.bin", 14}));
  EXPECT_THAT(*s3_->list(scan_),
              ElementsAre(BlobInfo{"cloud.ply", 9}, BlobInfo{"report.json", 11}));
  EXPECT_EQ(**blobs_at(data_.path()), s3_->address());
  EXPECT_EQ(migrate_to_s3(migration(*s3_))->copied_count, 0u) << "again";
  const Result<MigrationCounts> back = migrate_from_s3(migration(*s3_));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->copied_count, 3u);
  EXPECT_EQ(*read_blob(files_, scan_, "cloud.ply", 100), "cloud.ply");
  EXPECT_EQ(*files_.size_bytes(other_, "empty"), 0u);
  EXPECT_TRUE(s3_->list(scan_)->empty());
  EXPECT_FALSE(*blobs_at(data_.path()));
  EXPECT_EQ(s3_->owner().error().code, ErrorCode::kNotFound);
}

// Every time one request further, until it is done.
TEST_F(MigrateTest, InterruptedAnywhereItGoesOnAndLosesNothing) {
  std::atomic<int> left = 0;
  test::S3Proxy proxy(SwiftServer::shared()->port(), [&](test::Exchange& exchange) {
    if (--left < 0) exchange.cut_after = 0;
  });
  S3Options options = options_;
  options.endpoint = "http://127.0.0.1:" + std::to_string(proxy.port());
  const auto everything_is_somewhere = [&] {
    for (const char* name : {"cloud.ply", "report.json"}) {
      const bool here = files_.size_bytes(scan_, name).ok(),
                 there = s3_->size_bytes(scan_, name).ok();
      const bool noted = (*blobs_at(data_.path())).has_value();
      EXPECT_TRUE(noted ? there : here) << name << " is missing where a server looks for it";
    }
  };
  for (const bool away : {true, false}) {
    int tries = 0;
    for (bool done = false; !done && tries < 60; ++tries) {
      left = tries;
      S3Blobs s3(options);
      done = (away ? migrate_to_s3(migration(s3)) : migrate_from_s3(migration(s3))).ok();
      everything_is_somewhere();
    }
    EXPECT_GT(tries, 5);
    EXPECT_LT(tries, 60);
  }
  EXPECT_EQ(*read_blob(files_, scan_, "cloud.ply", 100), "cloud.ply");
}

TEST_F(MigrateTest, WhatComesBackWrongRemovesNothing) {
  test::S3Proxy proxy(SwiftServer::shared()->port(), [](test::Exchange& exchange) {
    if (exchange.request.count("Range") > 0 && exchange.response.body() == "cloud.ply")
      exchange.response.body() = "cloud.plx";
  });
  S3Options options = options_;
  options.endpoint = "http://127.0.0.1:" + std::to_string(proxy.port());
  S3Blobs s3(options);
  EXPECT_EQ(migrate_to_s3(migration(s3)).error().code, ErrorCode::kIo);
  EXPECT_EQ(files_.list(scan_)->size(), 3u);
  EXPECT_FALSE(*blobs_at(data_.path()));
}

TEST_F(MigrateTest, WhatAServerHasRemovedDoesNotComeBack) {
  ASSERT_TRUE(migrate_to_s3(migration(*s3_)).ok());
  std::ofstream(data_ / "blob-removals") << scan_ << " cloud.ply\n";
  ASSERT_TRUE(migrate_from_s3(migration(*s3_)).ok());
  EXPECT_FALSE(files_.size_bytes(scan_, "cloud.ply").ok());
  EXPECT_TRUE(files_.size_bytes(scan_, "report.json").ok());
}

TEST_F(MigrateTest, AnotherFolderDoesNotTakeThePrefix) {
  ASSERT_TRUE(migrate_to_s3(migration(*s3_)).ok());
  const test::TemporaryFolder other;
  FileBlobs files(other.path());
  const Migration of_other{other.path(), files, *s3_, {}, {}, other / "blob-removals"};
  EXPECT_EQ(migrate_to_s3(of_other).error().code, ErrorCode::kBusy);
  EXPECT_EQ(migrate_from_s3(of_other).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(s3_->list(scan_)->size(), 2u);
}

}  // namespace
}  // namespace hermite::server
