#include "core/image/zstd_bytes.h"

#include <gtest/gtest.h>

namespace hermite::image {
namespace {

std::string some_bytes() {
  std::string bytes;
  for (int i = 0; i < 5000; ++i) bytes += static_cast<char>(i * i % 251);
  return bytes;
}

TEST(ZstdBytes, ComeBackAsTheyWere) {
  for (const std::string& bytes :
       {std::string(), std::string("a"), std::string(100'000, 'x'), some_bytes()}) {
    const Result<std::string> back = decompress_bytes(compress_bytes(bytes), bytes.size());
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(*back, bytes);
  }
}

TEST(ZstdBytes, WhatIsCutOrDamagedIsCorrupt) {
  const std::string frame = compress_bytes(some_bytes());
  for (std::size_t length = 0; length < frame.size(); length += 7)
    EXPECT_FALSE(decompress_bytes(std::string_view(frame).substr(0, length), 1 << 20).ok())
        << length;
  EXPECT_EQ(decompress_bytes(frame + "x", 1 << 20).error().code, ErrorCode::kCorruptData);
  for (std::size_t at = 0; at < frame.size(); at += 11) {
    std::string damaged = frame;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const Result<std::string> back = decompress_bytes(damaged, 1 << 20);
    EXPECT_TRUE(!back.ok() || *back == some_bytes())
        << at << ": a bit that says nothing may be lost";
  }
}

TEST(ZstdBytes, MoreThanIsAllowedIsNotAllocated) {
  EXPECT_EQ(decompress_bytes(compress_bytes(std::string(1000, 'x')), 999).error().code,
            ErrorCode::kTooLarge);
}

}  // namespace
}  // namespace hermite::image
