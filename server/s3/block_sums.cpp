#include "server/s3/block_sums.h"

#include <algorithm>
#include <charconv>

#include "core/base/check.h"
#include "core/digest/sha256.h"

namespace hermite::server {

namespace {

constexpr std::size_t kDigits = 16;  // of a sum
// Some servers take 256 characters in one value.
constexpr std::size_t kDigitsInHeader = 15 * kDigits;
constexpr const char* kBlockHeader = "x-amz-meta-hermite-block";
constexpr const char* kSumsHeader = "x-amz-meta-hermite-sums-";

std::uint64_t block_count(std::uint64_t size_bytes, std::uint64_t block_bytes) {
  return (size_bytes + block_bytes - 1) / block_bytes;
}

}  // namespace

BlockSums block_sums(std::string_view bytes) {
  BlockSums sums{bytes.size(),
                 std::max<std::uint64_t>(kLeastBlock_bytes, block_count(bytes.size(), kMaxBlocks)),
                 {}};
  for (std::uint64_t from = 0; from < bytes.size(); from += sums.block_bytes)
    sums.sums.push_back(
        digest::sha256_hex(bytes.substr(from, sums.block_bytes)).substr(0, kDigits));
  return sums;
}

bool is_block(const BlockSums& sums, std::size_t number, std::string_view block) {
  CHECK(number < sums.sums.size(), "a block behind the end");
  return digest::sha256_hex(block).substr(0, kDigits) == sums.sums[number];
}

S3Headers metadata_of(const BlockSums& sums) {
  std::string digits;
  for (const std::string& sum : sums.sums) digits += sum;
  S3Headers headers{{kBlockHeader, std::to_string(sums.block_bytes)}};
  for (std::size_t from = 0; from < digits.size(); from += kDigitsInHeader)
    headers.emplace_back(kSumsHeader + std::to_string(from / kDigitsInHeader),
                         digits.substr(from, kDigitsInHeader));
  return headers;
}

Result<BlockSums> parse_metadata(const std::map<std::string, std::string>& headers,
                                 std::uint64_t size_bytes) {
  const Error wrong{
      ErrorCode::kIo,
      "it has no checksums, or those of something else: it was not stored by Hermite"};
  BlockSums sums{size_bytes, 0, {}};
  const auto block = headers.find(kBlockHeader);
  if (block == headers.end()) return wrong;
  const char* const end = block->second.data() + block->second.size();
  const auto [stop, error] = std::from_chars(block->second.data(), end, sums.block_bytes);
  if (error != std::errc() || stop != end || sums.block_bytes < kLeastBlock_bytes) return wrong;
  std::string digits;
  for (std::size_t i = 0; digits.size() < kMaxBlocks * kDigits; ++i) {
    const auto part = headers.find(kSumsHeader + std::to_string(i));
    if (part == headers.end()) break;
    digits += part->second;
  }
  const std::uint64_t count = size_bytes == 0 ? 0 : (size_bytes - 1) / sums.block_bytes + 1;
  if (count > kMaxBlocks || digits.size() != count * kDigits) return wrong;
  for (std::size_t i = 0; i < count; ++i) sums.sums.push_back(digits.substr(i * kDigits, kDigits));
  return sums;
}

}  // namespace hermite::server
