// The binary format of a frame log; frame_log.md describes it. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hermite::frame_log {

inline constexpr std::size_t kSegmentHeaderBytes = 16;
inline constexpr std::size_t kRecordHeaderBytes = 24;
inline constexpr std::uint64_t kMaxSegmentBytes = 64 * 1024 * 1024;
// Limit for the payload; the longest frame message (2048 x 2048) has 33.6 MB.
inline constexpr std::size_t kMaxRecordBytes = 40 * 1024 * 1024;

enum class RecordType : std::uint32_t {
  kTerms = 1,
  kStart = 2,
  kFrame = 3,
  kRefusedFrame = 4,
  kFinish = 5
};

struct RecordHeader {
  std::uint32_t crc = 0;
  std::uint32_t length = 0;  // of the payload, at most kMaxRecordBytes
  RecordType type = RecordType::kFrame;
  std::uint64_t number = 0;
};

// Returns the CRC-32C of `bytes`, continuing from `crc` of the bytes before them.
std::uint32_t crc32c(std::string_view bytes, std::uint32_t crc = 0);

std::string segment_name(std::uint32_t segment);
std::string format_segment_header(std::uint32_t segment);
std::string format_record_header(RecordType type, std::uint64_t number, std::string_view payload);

// Returns nullopt if these kRecordHeaderBytes are not a header, the type is unknown, or the payload
// is too long.
std::optional<RecordHeader> parse_record_header(std::string_view bytes);

// Returns whether the checksum in the header matches header and payload.
bool crc_fits(std::string_view header, std::string_view payload);

}  // namespace hermite::frame_log
