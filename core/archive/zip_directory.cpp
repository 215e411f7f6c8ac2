#include "core/archive/zip_directory.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace hermite::archive {
namespace {

constexpr std::array<std::uint8_t, 4> kEnd = {'P', 'K', 5, 6};
constexpr std::int64_t kEndRecord_bytes = 22, kMaxComment_bytes = 65535;
constexpr std::int64_t kLocator_bytes = 20, kEnd64_bytes = 56;
constexpr std::int64_t kMinEntry_bytes = 46;  // without a name
constexpr std::uint32_t kSeeEnd64 = 0xffffffff;

template <class Value>
Value little_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  Value value = 0;
  for (std::size_t i = 0; i < sizeof value; ++i)
    value |= static_cast<Value>(static_cast<Value>(bytes[at + i]) << (8 * i));
  return value;
}

Error corrupt(const std::string& message) { return {ErrorCode::kCorruptData, "zip: " + message}; }

Result<std::vector<std::uint8_t>> read_at(int descriptor, std::int64_t offset, std::int64_t count) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(count));
  if (offset < 0 ||
      pread(descriptor, bytes.data(), bytes.size(), offset) != static_cast<ssize_t>(count))
    return corrupt(fmt::format("cannot read {} bytes at offset {}", count, offset));
  return bytes;
}

// Where the directory begins when the end record has no room for the number.
Result<std::int64_t> begin_from_end64(int descriptor, std::int64_t end_offset) {
  const auto locator = read_at(descriptor, end_offset - kLocator_bytes, kLocator_bytes);
  if (!locator.ok()) return locator.error();
  const auto end64_offset = little_endian<std::uint64_t>(*locator, 8);
  if (end64_offset >= static_cast<std::uint64_t>(end_offset))
    return corrupt("the zip64 end record lies behind the end");
  const auto end64 = read_at(descriptor, static_cast<std::int64_t>(end64_offset), kEnd64_bytes);
  if (!end64.ok()) return end64.error();
  return static_cast<std::int64_t>(std::min(little_endian<std::uint64_t>(*end64, 48),
                                            static_cast<std::uint64_t>(end_offset) + 1));
}

}  // namespace

Result<std::int64_t> max_zip_entries(int descriptor, std::int64_t file_bytes) {
  const std::int64_t tail_bytes = std::min(file_bytes, kEndRecord_bytes + kMaxComment_bytes);
  const auto tail = read_at(descriptor, file_bytes - tail_bytes, tail_bytes);
  if (!tail.ok()) return tail.error();
  const auto found = std::find_end(tail->begin(), tail->end(), kEnd.begin(), kEnd.end());
  const std::int64_t at = found - tail->begin();
  if (found == tail->end() || tail_bytes - at < kEndRecord_bytes)
    return corrupt("no directory at its end: cut short");
  const std::int64_t end_offset = file_bytes - tail_bytes + at;
  std::int64_t begin = little_endian<std::uint32_t>(*tail, static_cast<std::size_t>(at) + 16);
  if (begin == kSeeEnd64) {
    const Result<std::int64_t> far_begin = begin_from_end64(descriptor, end_offset);
    if (!far_begin.ok()) return far_begin.error();
    begin = *far_begin;
  }
  if (begin > end_offset)
    return corrupt(
        fmt::format("the directory begins at {}, behind its end at {}", begin, end_offset));
  return (end_offset - begin) / kMinEntry_bytes;
}

}  // namespace hermite::archive
