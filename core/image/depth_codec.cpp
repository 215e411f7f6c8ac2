#include "core/image/depth_codec.h"

#include <fmt/core.h>
#include <zstd.h>

#include <bit>
#include <cstring>
#include <memory>
#include <string>

#include "core/image/corrupt_depth.h"

namespace hermite::image {
namespace {

static_assert(std::endian::native == std::endian::little,
              "RVL words are copied as they lie in memory");

constexpr int kZstdLevel = 1;
constexpr int kGroupsPerWord = 8;
constexpr int kMaxGroupsPerNumber = 10;  // 30 bits: more than any run or difference needs

class RvlWriter {
 public:
  explicit RvlWriter(std::size_t max_words) { words_.reserve(max_words); }

  void put(std::uint32_t number) {
    do {
      const std::uint32_t rest = number >> 3;
      word_ = (word_ << 4) | (number & 7u) | (rest != 0 ? 8u : 0u);
      number = rest;
      if (++group_count_ == kGroupsPerWord) flush();
    } while (number != 0);
  }

  std::vector<std::uint32_t> finish() && {
    if (group_count_ > 0) {
      word_ <<= 4 * (kGroupsPerWord - group_count_);
      flush();
    }
    return std::move(words_);
  }

 private:
  void flush() {
    words_.push_back(word_);
    word_ = 0;
    group_count_ = 0;
  }

  std::vector<std::uint32_t> words_;
  std::uint32_t word_ = 0;
  int group_count_ = 0;
};

class RvlReader {
 public:
  explicit RvlReader(std::span<const std::uint32_t> words) : words_(words) {}

  // False when the words end inside the number or it has too many groups.
  bool get(std::uint32_t& number) {
    number = 0;
    for (int group = 0; group < kMaxGroupsPerNumber; ++group) {
      if (groups_left_ == 0) {
        if (next_ == words_.size()) return false;
        word_ = words_[next_++];
        groups_left_ = kGroupsPerWord;
      }
      const std::uint32_t nibble = word_ >> 28;
      word_ <<= 4;
      --groups_left_;
      number |= (nibble & 7u) << (3 * group);
      if ((nibble & 8u) == 0) return true;
    }
    return false;
  }

  // Nothing but the padding of the last word is left.
  bool at_end() const { return next_ == words_.size() && word_ == 0; }

 private:
  std::span<const std::uint32_t> words_;
  std::size_t next_ = 0;
  std::uint32_t word_ = 0;
  int groups_left_ = 0;
};

std::uint32_t zigzag(std::int32_t difference) {
  return (static_cast<std::uint32_t>(difference) << 1) ^
         static_cast<std::uint32_t>(difference >> 31);
}

std::int32_t unzigzag(std::uint32_t number) {
  return static_cast<std::int32_t>(number >> 1) ^ -static_cast<std::int32_t>(number & 1u);
}

// The words of RVL out of the zstd frame.
Result<std::vector<std::uint32_t>> unpack_words(std::span<const std::uint8_t> bytes,
                                                std::size_t max_bytes) {
  std::uint32_t magic = 0;
  if (bytes.size() >= sizeof(magic)) std::memcpy(&magic, bytes.data(), sizeof(magic));
  if (magic != ZSTD_MAGICNUMBER)
    // Legacy and skippable ones are not taken either.
    return corrupt_depth(std::to_string(bytes.size()) + " bytes that are no zstd frame");
  const unsigned long long content_bytes = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (content_bytes == ZSTD_CONTENTSIZE_ERROR)
    return corrupt_depth("the zstd header is cut or damaged");
  if (content_bytes == ZSTD_CONTENTSIZE_UNKNOWN)
    return corrupt_depth("the zstd frame does not state its content size");
  if (content_bytes > max_bytes) {
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("depth: the zstd frame states {} bytes, the limit for this image is {}",
                    content_bytes, max_bytes)};
  }
  if (content_bytes == 0 || content_bytes % sizeof(std::uint32_t) != 0) {
    return corrupt_depth(
        fmt::format("RVL of {} bytes is not a number of 32-bit words", content_bytes));
  }
  if (ZSTD_findFrameCompressedSize(bytes.data(), bytes.size()) != bytes.size())
    return corrupt_depth("not exactly one whole zstd frame");

  std::vector<std::uint32_t> words(content_bytes / sizeof(std::uint32_t));
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  const std::size_t size =
      ZSTD_decompressDCtx(context.get(), words.data(), content_bytes, bytes.data(), bytes.size());
  if (ZSTD_isError(size)) return corrupt_depth(std::string("zstd: ") + ZSTD_getErrorName(size));
  if (size != content_bytes) return corrupt_depth("the zstd frame holds less than it states");
  return words;
}

}  // namespace

std::vector<std::uint32_t> encode_rvl(std::span<const std::uint16_t> pixels) {
  RvlWriter writer(max_rvl_bytes(pixels.size()) / sizeof(std::uint32_t));
  std::int32_t previous = 0;
  std::size_t at = 0;
  while (at < pixels.size()) {
    const std::size_t zeros_begin = at;
    while (at < pixels.size() && pixels[at] == 0) ++at;
    const std::size_t nonzeros_begin = at;
    while (at < pixels.size() && pixels[at] != 0) ++at;
    writer.put(static_cast<std::uint32_t>(nonzeros_begin - zeros_begin));
    writer.put(static_cast<std::uint32_t>(at - nonzeros_begin));
    for (std::size_t i = nonzeros_begin; i < at; ++i) {
      writer.put(zigzag(pixels[i] - previous));
      previous = pixels[i];
    }
  }
  return std::move(writer).finish();
}

Status decode_rvl(std::span<const std::uint32_t> words, std::span<std::uint16_t> pixels) {
  RvlReader reader(words);
  std::int32_t previous = 0;
  std::size_t at = 0;
  while (at < pixels.size()) {
    std::uint32_t zeros = 0, nonzeros = 0;
    if (!reader.get(zeros) || !reader.get(nonzeros))
      return corrupt_depth("RVL ends at pixel " + std::to_string(at));
    if (zeros == 0 && nonzeros == 0)
      return corrupt_depth("RVL has an empty run at pixel " + std::to_string(at));
    const std::size_t left = pixels.size() - at;
    if (zeros > left || nonzeros > left - zeros) {
      return corrupt_depth(
          fmt::format("RVL has a run of {} + {} pixels where {} are left", zeros, nonzeros, left));
    }
    at += zeros;
    for (const std::size_t end = at + nonzeros; at < end; ++at) {
      std::uint32_t number = 0;
      if (!reader.get(number)) return corrupt_depth("RVL ends at pixel " + std::to_string(at));
      const std::int32_t value = previous + unzigzag(number);  // no overflow: 16 bits plus 30 bits
      if (value < 1 || value > 65535)
        return corrupt_depth(fmt::format("RVL value {} at pixel {}", value, at));
      pixels[at] = static_cast<std::uint16_t>(value);
      previous = value;
    }
  }
  if (!reader.at_end()) return corrupt_depth("RVL goes on after the last pixel");
  return Done{};
}

std::vector<std::uint8_t> encode_depth_rvl_zstd(const DepthImage& depth) {
  CHECK(check_image_size({depth.width, depth.height}).ok(),
        "depth image to encode has no valid size");
  CHECK(depth.pixels.size() ==
            static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height),
        "depth image has other pixels than its size");
  const std::vector<std::uint32_t> words = encode_rvl(depth.pixels);
  const std::size_t rvl_bytes = words.size() * sizeof(std::uint32_t);

  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kZstdLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::vector<std::uint8_t> bytes(ZSTD_compressBound(rvl_bytes));
  const std::size_t size =
      ZSTD_compress2(context.get(), bytes.data(), bytes.size(), words.data(), rvl_bytes);
  CHECK(!ZSTD_isError(size), std::string("zstd refused to compress: ") + ZSTD_getErrorName(size));
  bytes.resize(size);
  return bytes;
}

Result<DepthImage> decode_depth_rvl_zstd(std::span<const std::uint8_t> bytes, ImageSize expected) {
  if (const Status valid = check_image_size(expected); !valid.ok()) return valid.error();
  const std::size_t pixel_count =
      static_cast<std::size_t>(expected.width) * static_cast<std::size_t>(expected.height);
  const Result<std::vector<std::uint32_t>> words = unpack_words(bytes, max_rvl_bytes(pixel_count));
  if (!words.ok()) return words.error();
  DepthImage depth(expected.width, expected.height);
  if (const Status decoded = decode_rvl(*words, depth.pixels); !decoded.ok())
    return decoded.error();
  return depth;
}

}  // namespace hermite::image
