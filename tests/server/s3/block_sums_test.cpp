#include "server/s3/block_sums.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace hermite::server {
namespace {

std::map<std::string, std::string> as_answer(const BlockSums& sums) {
  std::map<std::string, std::string> headers;
  for (const auto& [name, value] : metadata_of(sums)) headers[name] = value;
  return headers;
}

TEST(BlockSums, ComeBackFromMetadata) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{kLeastBlock_bytes},
                                 std::size_t{kLeastBlock_bytes + 1}}) {
    const BlockSums sums = block_sums(std::string(size, 'x'));
    EXPECT_EQ(*parse_metadata(as_answer(sums), size), sums) << size;
  }
}

// The most that S3 keeps is 2 KB, and other servers keep at most 256 characters in one value.
TEST(BlockSums, FitIntoMetadata) {
  BlockSums sums{kMaxBlocks * kLeastBlock_bytes, kLeastBlock_bytes,
                 std::vector<std::string>(kMaxBlocks, "0123456789abcdef")};
  std::size_t bytes = 0;
  for (const auto& [name, value] : metadata_of(sums)) {
    bytes += name.size() + value.size();
    EXPECT_LE(value.size(), 256u);
  }
  EXPECT_LE(bytes, 2048u);
  EXPECT_EQ(*parse_metadata(as_answer(sums), sums.size_bytes), sums);
}

TEST(BlockSums, TellOtherBytes) {
  std::string bytes(kLeastBlock_bytes + 10, 'x');
  const BlockSums sums = block_sums(bytes);
  ASSERT_EQ(sums.sums.size(), 2u);
  EXPECT_TRUE(is_block(sums, 1, std::string(10, 'x')));
  EXPECT_FALSE(is_block(sums, 1, std::string(9, 'x')));
  EXPECT_FALSE(is_block(sums, 0, std::string(10, 'x')));
}

TEST(BlockSums, ThatDoNotFitAreRefused) {
  const BlockSums sums = block_sums("bytes");
  auto headers = as_answer(sums);
  EXPECT_FALSE(parse_metadata({}, 5).ok());
  EXPECT_FALSE(parse_metadata(headers, 0).ok());
  EXPECT_FALSE(parse_metadata(headers, ~std::uint64_t{0}).ok());
  for (const char* block : {"", "0", "-1", "1", "4194304x", "99999999999999999999999"}) {
    headers["x-amz-meta-hermite-block"] = block;
    EXPECT_FALSE(parse_metadata(headers, 5).ok()) << block;
  }
}

}  // namespace
}  // namespace hermite::server
