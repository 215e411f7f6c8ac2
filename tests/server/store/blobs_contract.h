// What every Blobs keeps. An implementation is put through it with a world of its own:
//
//   struct World {
//     Blobs& blobs();
//     static constexpr bool kHidesWhatIsReplaced;  // a read while a blob is replaced may be told
//                                                  // that there is none
//     void die();  // the process is killed between two calls, and another one looks at what it
//                  // left
//     static std::string missing();  // may be left out: what this machine lacks; not empty: the
//                                    // tests are skipped
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(Files, BlobsContract, World);
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "server/store/blobs.h"
#include "server/store/scan_id.h"

namespace hermite::test {

template <class World>
class BlobsContract : public testing::Test {
 protected:
  void SetUp() override {
    if constexpr (requires { World::missing(); })
      if (const std::string reason = World::missing(); !reason.empty()) GTEST_SKIP() << reason;
  }
  server::Blobs& blobs() { return world_.blobs(); }
  std::string content(const std::string& name) {
    const Result<std::string> bytes = server::read_blob(blobs(), scan_, name, 1 << 24);
    return bytes.ok() ? *bytes : "error: " + bytes.error().message;
  }
  World world_;
  const std::string scan_ = server::new_scan_id();
};
TYPED_TEST_SUITE_P(BlobsContract);

TYPED_TEST_P(BlobsContract, ABlobComesBackAsItWasPut) {
  std::string all_bytes;
  for (int i = 0; i < 3 * 256; ++i) all_bytes.push_back(static_cast<char>(i));
  ASSERT_TRUE(this->blobs().put(this->scan_, "cloud.ply", all_bytes).ok());
  ASSERT_TRUE(this->blobs().put(this->scan_, "empty", "").ok());
  EXPECT_EQ(this->content("cloud.ply"), all_bytes);
  EXPECT_EQ(*this->blobs().size_bytes(this->scan_, "cloud.ply"), all_bytes.size());
  EXPECT_EQ(this->content("empty"), "");
  EXPECT_EQ(*this->blobs().size_bytes(this->scan_, "empty"), 0u);
}

TYPED_TEST_P(BlobsContract, AVersionIsOfOnePutAndStaysWhileNothingIsPut) {
  ASSERT_TRUE(this->blobs().put(this->scan_, "cloud.ply", "points").ok());
  const std::string first = *this->blobs().version(this->scan_, "cloud.ply");
  EXPECT_THAT(first, testing::MatchesRegex("[a-z0-9-]+"));
  EXPECT_EQ(*this->blobs().version(this->scan_, "cloud.ply"), first);
  ASSERT_TRUE(this->blobs().put(this->scan_, "cloud.ply", "others").ok());
  EXPECT_NE(*this->blobs().version(this->scan_, "cloud.ply"), first) << "of the same size";
  EXPECT_EQ(this->blobs().version(this->scan_, "none").error().code, ErrorCode::kNotFound);
}

TYPED_TEST_P(BlobsContract, IsReadInPieces) {
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "0123456789").ok());
  const auto piece = [this](std::uint64_t offset, std::size_t max_bytes) {
    return *this->blobs().read(this->scan_, "a", offset, max_bytes);
  };
  EXPECT_EQ(piece(0, 4), "0123");
  EXPECT_EQ(piece(4, 4), "4567");
  EXPECT_EQ(piece(8, 4), "89");
  EXPECT_EQ(piece(3, 0), "");
  EXPECT_EQ(piece(10, 4), "");
  EXPECT_EQ(piece(std::uint64_t{1} << 62, 4), "");
  EXPECT_EQ(piece(9, std::size_t{1} << 62), "9") << "what is asked for is not what is allocated";
}

TYPED_TEST_P(BlobsContract, WhatIsNotThereIsNotFound) {
  EXPECT_EQ(this->blobs().read(this->scan_, "a", 0, 1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->blobs().size_bytes(this->scan_, "a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(server::read_blob(this->blobs(), this->scan_, "a", 1).error().code,
            ErrorCode::kNotFound);
  EXPECT_TRUE(this->blobs().list(this->scan_)->empty());
  EXPECT_TRUE(this->blobs().remove(this->scan_).ok());
  ASSERT_TRUE(this->blobs().put(this->scan_, "b", "x").ok());
  EXPECT_EQ(this->blobs().read(this->scan_, "a", 0, 1).error().code, ErrorCode::kNotFound);
}

TYPED_TEST_P(BlobsContract, MoreThanIsAllowedIsNotRead) {
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "0123456789").ok());
  EXPECT_EQ(server::read_blob(this->blobs(), this->scan_, "a", 9).error().code,
            ErrorCode::kTooLarge);
  EXPECT_EQ(*server::read_blob(this->blobs(), this->scan_, "a", 10), "0123456789");
}

TYPED_TEST_P(BlobsContract, PutAgainItIsReplaced) {
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "a long first one").ok());
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "short").ok());
  EXPECT_EQ(this->content("a"), "short");
  EXPECT_EQ(this->blobs().list(this->scan_)->size(), 1u);
}

TYPED_TEST_P(BlobsContract, AScanListsItsOwnByName) {
  for (const char* name : {"report.json", "cloud.ply", "chunks.bin"})
    ASSERT_TRUE(this->blobs().put(this->scan_, name, name).ok());
  ASSERT_TRUE(this->blobs().put(server::new_scan_id(), "other", "x").ok());
  const Result<std::vector<server::BlobInfo>> found = this->blobs().list(this->scan_);
  ASSERT_TRUE(found.ok());
  EXPECT_THAT(*found, testing::ElementsAre(server::BlobInfo{"chunks.bin", 10},
                                           server::BlobInfo{"cloud.ply", 9},
                                           server::BlobInfo{"report.json", 11}));
}

TYPED_TEST_P(BlobsContract, RemovesOneAndNothingElse) {
  for (const char* name : {"a", "b"}) ASSERT_TRUE(this->blobs().put(this->scan_, name, "x").ok());
  EXPECT_TRUE(this->blobs().remove(this->scan_, "a").ok());
  EXPECT_TRUE(this->blobs().remove(this->scan_, "a").ok()) << "it is not there: all is well";
  EXPECT_TRUE(this->blobs().remove(server::new_scan_id(), "a").ok());
  EXPECT_EQ(this->blobs().size_bytes(this->scan_, "a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->content("b"), "x");
}

TYPED_TEST_P(BlobsContract, RemovesAllOfOneScanAndNothingElse) {
  const std::string other = server::new_scan_id();
  for (const std::string& scan : {this->scan_, other})
    for (const char* name : {"a", "b"}) ASSERT_TRUE(this->blobs().put(scan, name, "x").ok());
  ASSERT_TRUE(this->blobs().remove(this->scan_).ok());
  EXPECT_TRUE(this->blobs().list(this->scan_)->empty());
  EXPECT_EQ(this->blobs().size_bytes(this->scan_, "a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->blobs().list(other)->size(), 2u);
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "again").ok());
  EXPECT_EQ(this->content("a"), "again");
}

TYPED_TEST_P(BlobsContract, WhatWasPutSurvivesADeath) {
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", "kept").ok());
  ASSERT_TRUE(this->blobs().put(this->scan_, "b", "old").ok());
  ASSERT_TRUE(this->blobs().put(this->scan_, "b", "new").ok());
  this->world_.die();
  EXPECT_EQ(this->content("a"), "kept");
  EXPECT_EQ(this->content("b"), "new");
}

TYPED_TEST_P(BlobsContract, IsWholeForWhoeverReadsWhileItIsReplaced) {
  constexpr std::size_t kBytes = 200'000;
  ASSERT_TRUE(this->blobs().put(this->scan_, "a", std::string(kBytes, 'a')).ok());
  std::atomic<bool> over = false;
  std::thread writing([&] {
    for (int i = 0; i < 40; ++i)
      EXPECT_TRUE(this->blobs()
                      .put(this->scan_, "a", std::string(kBytes, static_cast<char>('a' + i % 26)))
                      .ok());
    over = true;
  });
  int torn_count = 0;
  while (!over) {
    const Result<std::string> bytes = this->blobs().read(this->scan_, "a", 0, kBytes);
    if (!bytes.ok() && bytes.error().code == ErrorCode::kNotFound &&
        TypeParam::kHidesWhatIsReplaced)
      continue;
    EXPECT_TRUE(bytes.ok()) << bytes.error().message;
    if (bytes.ok() && *bytes != std::string(kBytes, bytes->front())) ++torn_count;
  }
  writing.join();
  EXPECT_EQ(torn_count, 0);
  EXPECT_EQ(this->blobs().list(this->scan_)->size(), 1u) << "nothing of the way there is left";
}

REGISTER_TYPED_TEST_SUITE_P(BlobsContract, ABlobComesBackAsItWasPut,
                            AVersionIsOfOnePutAndStaysWhileNothingIsPut, IsReadInPieces,
                            WhatIsNotThereIsNotFound, MoreThanIsAllowedIsNotRead,
                            PutAgainItIsReplaced, AScanListsItsOwnByName, RemovesOneAndNothingElse,
                            RemovesAllOfOneScanAndNothingElse, WhatWasPutSurvivesADeath,
                            IsWholeForWhoeverReadsWhileItIsReplaced);

}  // namespace hermite::test
