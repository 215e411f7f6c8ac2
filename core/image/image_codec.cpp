#include "core/image/image_codec.h"

#include <fmt/core.h>
#include <spng.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <string>

namespace hermite::image {
namespace {

constexpr std::array<std::uint8_t, 3> kJpegStart = {0xff, 0xd8, 0xff};
constexpr std::array<std::uint8_t, 8> kPngStart = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// Fixed, so that every program sees the same pixels. A warning means damaged data, which must not
// pass as an image.
constexpr int kJpegDecodeFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
constexpr int kJpegEncodeFlags = TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC;

// A progressive JPEG costs a pass over the whole image for every scan, however empty: a camera
// writes 1, a progressive encoder about 10, and each thumbnail in the metadata has its own.
constexpr int kMaxJpegScans = 32;

// What we read of a PNG beside pixels is nothing, so what it may make us keep is little. (libspng
// itself stops at 1000 chunks.)
constexpr std::size_t kMaxPngChunk_bytes = std::size_t{1} << 20;
constexpr std::size_t kMaxPngChunkCache_bytes = std::size_t{2} << 20;
constexpr int kPngLevel = 1;

std::string text_of(ImageSize size) { return fmt::format("{}x{}", size.width, size.height); }

std::size_t pixel_count(ImageSize size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

Error corrupt(const std::string& message) { return {ErrorCode::kCorruptData, message}; }

Error other_size(const char* format, ImageSize found, ImageSize expected) {
  return {ErrorCode::kTooLarge, fmt::format("{} of {} pixels where {} are expected", format,
                                            text_of(found), text_of(expected))};
}

template <std::size_t N>
bool starts_with(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, N>& start) {
  return bytes.size() >= N && std::equal(start.begin(), start.end(), bytes.begin());
}

struct TurboRelease {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Turbo = std::unique_ptr<void, TurboRelease>;

Turbo checked(tjhandle handle) {
  if (handle == nullptr) throw std::bad_alloc();
  return Turbo(handle);
}

Error jpeg_error(const Turbo& turbo) {
  return corrupt(std::string("JPEG: ") + tjGetErrorStr2(turbo.get()));
}

struct JpegHeader {
  ImageSize size;
  int color_space = 0;  // TJCS
};

Result<JpegHeader> read_jpeg_header(const Turbo& turbo, std::span<const std::uint8_t> bytes) {
  JpegHeader header;
  int subsampling = 0;
  if (tjDecompressHeader3(turbo.get(), bytes.data(), bytes.size(), &header.size.width,
                          &header.size.height, &subsampling, &header.color_space) != 0) {
    return jpeg_error(turbo);
  }
  if (header.size.width < 1 || header.size.height < 1) return corrupt("JPEG: no image in it");
  if (!check_image_size(header.size).ok()) {
    return Error{ErrorCode::kTooLarge, fmt::format("JPEG of {} pixels, the limit is {} an edge",
                                                   text_of(header.size), kMaxImageEdge_px)};
  }
  return header;
}

// Start-of-scan markers. Inside compressed data 0xff is always followed by 0x00 or a restart
// marker, so that none is missed.
int count_jpeg_scans(std::span<const std::uint8_t> bytes) {
  int count = 0;
  for (std::size_t i = 1; i < bytes.size(); ++i) count += bytes[i - 1] == 0xff && bytes[i] == 0xda;
  return count;
}

Result<ColorImage> decode_jpeg(std::span<const std::uint8_t> bytes, ImageSize expected) {
  const Turbo turbo = checked(tjInitDecompress());
  const Result<JpegHeader> header = read_jpeg_header(turbo, bytes);
  if (!header.ok()) return header.error();
  if (header->size != expected) return other_size("JPEG", header->size, expected);
  if (header->color_space == TJCS_CMYK || header->color_space == TJCS_YCCK) {
    return Error{ErrorCode::kUnsupported,
                 "JPEG with CMYK colours, only grey, YCbCr and RGB are read"};
  }
  if (const int scans = count_jpeg_scans(bytes); scans > kMaxJpegScans) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("JPEG with {} scans, the limit is {}", scans, kMaxJpegScans)};
  }
  ColorImage image(expected.width, expected.height);
  if (tjDecompress2(turbo.get(), bytes.data(), bytes.size(), &image.pixels.data()->r, image.width,
                    0, image.height, TJPF_RGB, kJpegDecodeFlags) != 0) {
    return jpeg_error(turbo);
  }
  return image;
}

struct SpngRelease {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Spng = std::unique_ptr<spng_ctx, SpngRelease>;

Error png_error(int code) {
  const std::string message = std::string("PNG: ") + spng_strerror(code);
  switch (code) {
    case SPNG_EMEM: throw std::bad_alloc();
    case SPNG_EUSER_WIDTH:
    case SPNG_EUSER_HEIGHT:
      return {ErrorCode::kTooLarge,
              fmt::format("{}, the limit is {} pixels an edge", message, kMaxImageEdge_px)};
    case SPNG_ECHUNK_LIMITS:
      return {ErrorCode::kTooLarge,
              fmt::format("{}, the limit for metadata is {} bytes", message, kMaxPngChunk_bytes)};
    default: return {ErrorCode::kCorruptData, message};
  }
}

// `bytes` must outlive what is returned.
Result<Spng> open_png(std::span<const std::uint8_t> bytes) {
  Spng png(spng_ctx_new(0));
  if (!png) throw std::bad_alloc();
  for (const int code :
       {spng_set_crc_action(png.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR),
        spng_set_image_limits(png.get(), kMaxImageEdge_px, kMaxImageEdge_px),
        spng_set_chunk_limits(png.get(), kMaxPngChunk_bytes, kMaxPngChunkCache_bytes),
        spng_set_png_buffer(png.get(), bytes.data(), bytes.size())}) {
    if (code != 0) return png_error(code);
  }
  return png;
}

Result<spng_ihdr> read_png_header(const Spng& png) {
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(png.get(), &header); code != 0) return png_error(code);
  return header;
}

ImageSize size_of(const spng_ihdr& header) {
  return {static_cast<int>(header.width), static_cast<int>(header.height)};
}

// Pixels of an opened PNG whose header was read, and everything behind them: a file that is cut
// after its last pixel is cut all the same.
template <class Pixel>
Result<Image<Pixel>> decode_png_pixels(const Spng& png, ImageSize size, spng_format format) {
  std::size_t decoded_bytes = 0;
  if (const int code = spng_decoded_image_size(png.get(), format, &decoded_bytes); code != 0)
    return png_error(code);
  CHECK(decoded_bytes == pixel_count(size) * sizeof(Pixel),
        "libspng counts other bytes for these pixels");
  Image<Pixel> image(size.width, size.height);
  if (const int code = spng_decode_image(png.get(), image.pixels.data(), decoded_bytes, format, 0);
      code != 0)
    return png_error(code);
  if (const int code = spng_decode_chunks(png.get()); code != 0) return png_error(code);
  return image;
}

Result<ColorImage> decode_color_png(std::span<const std::uint8_t> bytes, ImageSize expected) {
  const Result<Spng> png = open_png(bytes);
  if (!png.ok()) return png.error();
  const Result<spng_ihdr> header = read_png_header(*png);
  if (!header.ok()) return header.error();
  if (size_of(*header) != expected) return other_size("PNG", size_of(*header), expected);
  if (header->bit_depth != 8) {
    return Error{
        ErrorCode::kUnsupported,
        fmt::format("colour PNG with {} bits a channel, only 8 are read", header->bit_depth)};
  }
  return decode_png_pixels<Rgb8>(*png, expected, SPNG_FMT_RGB8);
}

template <class Pixel>
Result<std::vector<std::uint8_t>> encode_png_pixels(const Image<Pixel>& image,
                                                    spng_color_type color_type,
                                                    std::uint8_t bit_depth) {
  const ImageSize size{image.width, image.height};
  if (const Status valid = check_image_size(size); !valid.ok()) return valid.error();
  CHECK(image.pixels.size() == pixel_count(size), "image has other pixels than its size");
  const Spng png(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!png) throw std::bad_alloc();
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width);
  header.height = static_cast<std::uint32_t>(image.height);
  header.bit_depth = bit_depth;
  header.color_type = static_cast<std::uint8_t>(color_type);
  for (const int code : {spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1),
                         spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, kPngLevel),
                         spng_set_option(png.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB),
                         spng_set_ihdr(png.get(), &header)}) {
    if (code != 0) return png_error(code);
  }
  const std::size_t pixels_bytes = image.pixels.size() * sizeof(Pixel);
  if (const int code = spng_encode_image(png.get(), image.pixels.data(), pixels_bytes, SPNG_FMT_PNG,
                                         SPNG_ENCODE_FINALIZE);
      code != 0)
    return png_error(code);
  std::size_t size_bytes = 0;
  int code = 0;
  const std::unique_ptr<void, decltype(&std::free)> buffer(
      spng_get_png_buffer(png.get(), &size_bytes, &code), std::free);
  if (!buffer) return png_error(code);
  const auto* begin = static_cast<const std::uint8_t*>(buffer.get());
  return std::vector<std::uint8_t>(begin, begin + size_bytes);
}

}  // namespace

Status check_image_size(ImageSize size) {
  if (size.width < 1 || size.height < 1 || size.width > kMaxImageEdge_px ||
      size.height > kMaxImageEdge_px) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("image size {} is not 1 to {} pixels an edge", text_of(size),
                             kMaxImageEdge_px)};
  }
  return Done{};
}

Result<ImageFormat> detect_image_format(std::span<const std::uint8_t> bytes) {
  if (starts_with(bytes, kJpegStart)) return ImageFormat::kJpeg;
  if (starts_with(bytes, kPngStart)) return ImageFormat::kPng;
  return Error{ErrorCode::kUnsupported,
               bytes.empty() ? "image without bytes" : "image that is neither JPEG nor PNG"};
}

Result<ImageSize> read_image_size(std::span<const std::uint8_t> bytes) {
  const Result<ImageFormat> format = detect_image_format(bytes);
  if (!format.ok()) return Error{ErrorCode::kCorruptData, format.error().message};
  if (*format == ImageFormat::kJpeg) {
    const Turbo turbo = checked(tjInitDecompress());
    const Result<JpegHeader> header = read_jpeg_header(turbo, bytes);
    if (!header.ok()) return header.error();
    return header->size;
  }
  const Result<Spng> png = open_png(bytes);
  if (!png.ok()) return png.error();
  const Result<spng_ihdr> header = read_png_header(*png);
  if (!header.ok()) return header.error();
  return size_of(*header);
}

Result<ColorImage> decode_color(std::span<const std::uint8_t> bytes, ImageSize expected) {
  if (const Status valid = check_image_size(expected); !valid.ok()) return valid.error();
  const Result<ImageFormat> format = detect_image_format(bytes);
  if (!format.ok()) return format.error();
  return *format == ImageFormat::kJpeg ? decode_jpeg(bytes, expected)
                                       : decode_color_png(bytes, expected);
}

Result<DepthImage> decode_depth_png(std::span<const std::uint8_t> bytes, ImageSize expected) {
  if (const Status valid = check_image_size(expected); !valid.ok()) return valid.error();
  const Result<ImageFormat> format = detect_image_format(bytes);
  if (!format.ok() || *format != ImageFormat::kPng)
    return Error{ErrorCode::kUnsupported, "depth image that is no PNG"};
  const Result<Spng> png = open_png(bytes);
  if (!png.ok()) return png.error();
  const Result<spng_ihdr> header = read_png_header(*png);
  if (!header.ok()) return header.error();
  if (size_of(*header) != expected) return other_size("depth PNG", size_of(*header), expected);
  if (header->color_type != SPNG_COLOR_TYPE_GRAYSCALE || header->bit_depth != 16) {
    return Error{
        ErrorCode::kUnsupported,
        fmt::format("depth PNG with colour type {} and {} bits a channel, only 16-bit grey is read",
                    header->color_type, header->bit_depth)};
  }
  return decode_png_pixels<std::uint16_t>(*png, expected, SPNG_FMT_PNG);
}

Result<std::vector<std::uint8_t>> encode_jpeg(const ColorImage& image, int quality,
                                              JpegColor color) {
  const ImageSize size{image.width, image.height};
  if (const Status valid = check_image_size(size); !valid.ok()) return valid.error();
  CHECK(image.pixels.size() == pixel_count(size), "image has other pixels than its size");
  if (quality < 1 || quality > 100)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("JPEG quality {} is not 1 to 100", quality)};
  const Turbo turbo = checked(tjInitCompress());
  const int subsampling = color == JpegColor::kHalf ? TJSAMP_420 : TJSAMP_444;
  unsigned long size_bytes = tjBufSize(image.width, image.height, subsampling);
  std::vector<std::uint8_t> bytes(size_bytes);
  unsigned char* out = bytes.data();
  if (tjCompress2(turbo.get(), &image.pixels.data()->r, image.width, 0, image.height, TJPF_RGB,
                  &out, &size_bytes, subsampling, quality, kJpegEncodeFlags) != 0) {
    return jpeg_error(turbo);
  }
  bytes.resize(size_bytes);
  return bytes;
}

Result<std::vector<std::uint8_t>> encode_png(const ColorImage& image) {
  return encode_png_pixels(image, SPNG_COLOR_TYPE_TRUECOLOR, 8);
}

Result<std::vector<std::uint8_t>> encode_depth_png(const DepthImage& image) {
  return encode_png_pixels(image, SPNG_COLOR_TYPE_GRAYSCALE, 16);
}

}  // namespace hermite::image
