#include "core/image/nibble_depth.h"

#include <fmt/core.h>

#include <string>
#include <vector>

namespace hermite::image {
namespace {

constexpr int kNibbleBias = 6, kLongBias = 192;
constexpr int kNothing = 0x0d, kLongValue = 0x0f;
constexpr int kFirstRun = 0xe0, kLongAlone = 0xff;

Error damaged(const std::string& message) {
  return {ErrorCode::kCorruptData, "compressed depth: " + message};
}

class Decoder {
 public:
  // `table`: what the coded values are places in; empty: they are the depth.
  Decoder(std::span<const std::uint8_t> bytes, std::vector<std::uint16_t> table, ImageSize size)
      : bytes_(bytes), table_(std::move(table)), image_(size.width, size.height) {}

  Result<DepthImage> decode() {
    if (bytes_.size() < 2) return damaged("it ends before the first pixel");
    value_ = static_cast<std::uint16_t>(bytes_[0] | bytes_[1] << 8);
    at_ = 2;
    bool good = put();
    while (good && at_ < bytes_.size()) {
      const int code = bytes_[at_++];
      good = code == kLongAlone  ? put_long()
             : code >= kFirstRun ? put_run(2 * (code & 0x0f))
                                 : put_pair(code >> 4, code & 0x0f);
    }
    if (!good) return damaged(fmt::format("{} at byte {} of {}", reason_, at_, bytes_.size()));
    if (filled_ < image_.pixels.size())
      return damaged(fmt::format("it has {} pixels of {}", filled_, image_.pixels.size()));
    return std::move(image_);
  }

 private:
  bool fails(const char* reason) {
    reason_ = reason;
    return false;
  }

  bool put() {
    if (filled_ == image_.pixels.size()) return fails("more pixels than the image has");
    if (!table_.empty() && value_ >= table_.size()) return fails("a place outside the table");
    image_.pixels[filled_++] = table_.empty() ? value_ : table_[value_];
    return true;
  }

  bool put_difference(int difference) {
    value_ = static_cast<std::uint16_t>(value_ - difference);  // modulo 2^16, as written
    return put();
  }

  bool put_run(int count) {
    for (int i = 0; i < count; ++i)
      if (!put()) return false;
    return true;
  }

  bool put_pair(int high, int low) {
    if (!put_difference(high - kNibbleBias)) return false;
    if (low == kLongValue) return put_long();
    return low == kNothing || put_difference(low - kNibbleBias);
  }

  bool put_long() {
    if (at_ == bytes_.size()) return fails("it is cut");
    const int first = bytes_[at_++];
    if (first >= 0x80) return put_difference(first - kLongBias);
    if (at_ == bytes_.size()) return fails("it is cut");
    value_ = static_cast<std::uint16_t>(first << 8 | bytes_[at_++]);
    return put();
  }

  const std::span<const std::uint8_t> bytes_;
  const std::vector<std::uint16_t> table_;
  DepthImage image_;
  std::size_t at_ = 0, filled_ = 0;
  std::uint16_t value_ = 0;
  std::string reason_;
};

}  // namespace

Result<DepthImage> decode_depth_nibbles(std::span<const std::uint8_t> bytes, ImageSize expected) {
  if (const Status status = check_image_size(expected); !status.ok()) return status.error();
  return Decoder(bytes, {}, expected).decode();
}

Result<DepthImage> decode_depth_nibbles_with_table(std::span<const std::uint8_t> bytes,
                                                   ImageSize expected) {
  if (const Status status = check_image_size(expected); !status.ok()) return status.error();
  const std::size_t count =
      bytes.size() < 2 ? 0 : static_cast<std::size_t>(bytes[0] | bytes[1] << 8);
  if (count == 0) return damaged("its table of values is empty");
  if (bytes.size() < 2 + 2 * count)
    return damaged(fmt::format("its table of {} values is cut", count));
  std::vector<std::uint16_t> table(count);
  for (std::size_t i = 0; i < count; ++i)
    table[i] = static_cast<std::uint16_t>(bytes[2 + 2 * i] | bytes[3 + 2 * i] << 8);
  return Decoder(bytes.subspan(2 + 2 * count), std::move(table), expected).decode();
}

}  // namespace hermite::image
