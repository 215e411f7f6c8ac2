#include "core/log/frame_log_format.h"

#include <array>
#include <bit>
#include <cstdio>
#include <cstring>

namespace hermite::frame_log {

namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are written in the byte order of the CPU");

constexpr std::string_view kSegmentMagic = "HRMFLOG1";
constexpr std::uint32_t kRecordMagic = 0x524d5248;  // "HRMR"
constexpr std::size_t kCrcOffset = 4, kCoveredOffset = 8;

// Processes eight bytes per step; table k is the CRC of a byte followed by k zero bytes. It reaches
// about 1.5 GB/s; one byte per step would reach a third of that.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;
constexpr CrcTables make_tables() {
  constexpr std::uint32_t kPolynomial = 0x82f63b78;  // Castagnoli polynomial, reflected
  CrcTables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? kPolynomial : 0);
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xff];
  return tables;
}
constexpr CrcTables kTables = make_tables();

template <class Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <class Number>
Number number_at(std::string_view bytes, std::size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

std::uint32_t crc32c(std::string_view bytes, std::uint32_t crc) {
  crc = ~crc;
  while (bytes.size() >= 8) {
    const std::uint64_t word = number_at<std::uint64_t>(bytes, 0) ^ crc;
    crc = 0;
    for (std::size_t k = 0; k < 8; ++k) crc ^= kTables[7 - k][(word >> (8 * k)) & 0xff];
    bytes.remove_prefix(8);
  }
  for (const char byte : bytes)
    crc = (crc >> 8) ^ kTables[0][(crc ^ static_cast<std::uint8_t>(byte)) & 0xff];
  return ~crc;
}

std::string segment_name(std::uint32_t segment) {
  char name[32];
  std::snprintf(name, sizeof name, "segment-%06u.rlog", static_cast<unsigned>(segment));
  return name;
}

std::string format_segment_header(std::uint32_t segment) {
  std::string bytes(kSegmentMagic);
  put(bytes, segment);
  put(bytes, crc32c(bytes));
  return bytes;
}

std::string format_record_header(RecordType type, std::uint64_t number, std::string_view payload) {
  std::string covered;
  put(covered, static_cast<std::uint32_t>(payload.size()));
  put(covered, static_cast<std::uint32_t>(type));
  put(covered, number);
  std::string bytes;
  put(bytes, kRecordMagic);
  put(bytes, crc32c(payload, crc32c(covered)));
  return bytes + covered;
}

std::optional<RecordHeader> parse_record_header(std::string_view bytes) {
  if (bytes.size() != kRecordHeaderBytes || number_at<std::uint32_t>(bytes, 0) != kRecordMagic)
    return std::nullopt;
  const auto type = number_at<std::uint32_t>(bytes, 12);
  const RecordHeader header{number_at<std::uint32_t>(bytes, kCrcOffset),
                            number_at<std::uint32_t>(bytes, kCoveredOffset),
                            static_cast<RecordType>(type), number_at<std::uint64_t>(bytes, 16)};
  const bool known = type >= static_cast<std::uint32_t>(RecordType::kTerms) &&
                     type <= static_cast<std::uint32_t>(RecordType::kFinish);
  if (!known || header.length > kMaxRecordBytes) return std::nullopt;
  return header;
}

bool crc_fits(std::string_view header, std::string_view payload) {
  return number_at<std::uint32_t>(header, kCrcOffset) ==
         crc32c(payload, crc32c(header.substr(kCoveredOffset)));
}

}  // namespace hermite::frame_log
