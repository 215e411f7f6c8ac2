#include "server/store/chunk_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::HasSubstr;

StoredChunks some_chunks() {
  StoredChunks stored;
  Vector6d twist;
  twist << 1, 2, 3, 0.1, 0.2, 0.3;
  stored.submaps = {{0, Rigid3{}}, {7, exp_se3(twist)}};
  stored.chunks = {{{0, 0, -1, 2, -3}, 10, "abc"},
                   {{7, 1, 32767, -32768, 0}, 20, std::string("\0\1\2\3", 4)},
                   {{7, 1, 0, 0, 0}, 0, ""}};
  return stored;
}

TEST(ChunkFile, ComesBackAsItWas) {
  const StoredChunks stored = some_chunks();
  const auto back = parse_chunk_file(format_chunk_file(stored));
  ASSERT_TRUE(back.ok()) << back.error().message;
  ASSERT_EQ(back->submaps.size(), 2u);
  EXPECT_EQ(back->submaps[1].submap, 7u);
  EXPECT_EQ(back->submaps[1].world_from_submap.translation,
            stored.submaps[1].world_from_submap.translation);
  EXPECT_EQ(back->submaps[1].world_from_submap.rotation.coeffs(),
            stored.submaps[1].world_from_submap.rotation.coeffs());
  ASSERT_EQ(back->chunks.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back->chunks[i].key, stored.chunks[i].key);
    EXPECT_EQ(back->chunks[i].point_count, stored.chunks[i].point_count);
    EXPECT_EQ(back->chunks[i].draco, stored.chunks[i].draco);
  }
}

TEST(ChunkFile, AnEmptyModelIsAFileToo) {
  const auto back = parse_chunk_file(format_chunk_file({}));
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(back->chunks.empty());
}

TEST(ChunkFile, EveryCutIsCorrupt) {
  const std::string bytes = format_chunk_file(some_chunks());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto back = parse_chunk_file(std::string_view(bytes).substr(0, length));
    ASSERT_FALSE(back.ok()) << length;
    EXPECT_EQ(back.error().code, ErrorCode::kCorruptData);
  }
}

TEST(ChunkFile, WhatStandsBehindTheEndIsCorrupt) {
  EXPECT_THAT(parse_chunk_file(format_chunk_file(some_chunks()) + "x").error().message,
              HasSubstr("behind the end"));
}

TEST(ChunkFile, CountsAndLengthsThatLieAreCorrupt) {
  const std::string good = format_chunk_file({});  // magic, 0 submaps, 0 chunks
  std::string bytes = good;
  bytes.replace(8, 4, "\xff\xff\xff\xff");
  EXPECT_FALSE(parse_chunk_file(bytes).ok());
  bytes = good;
  bytes.replace(12, 4, "\xff\xff\xff\xff");
  EXPECT_FALSE(parse_chunk_file(bytes).ok());
  StoredChunks large;
  large.chunks = {{{}, output::kMaxPointsPerChunk + 1, "x"}};
  EXPECT_THAT(parse_chunk_file(format_chunk_file(large)).error().message, HasSubstr("points"));
  EXPECT_THAT(parse_chunk_file("HRMCHNK2" + good.substr(8)).error().message, HasSubstr("HRMCHNK1"));
}

}  // namespace
}  // namespace hermite::server
