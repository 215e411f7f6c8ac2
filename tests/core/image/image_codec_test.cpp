#include "core/image/image_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <string_view>

#include "tests/support/data_folder.h"
#include "tests/support/file_bytes.h"
#include "tests/support/memory_peak.h"

namespace hermite::image {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr ImageSize kSize{61, 43};

ColorImage smooth_color(ImageSize size) {
  ColorImage image(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.at(x, y) = {static_cast<std::uint8_t>(x * 255 / size.width),
                        static_cast<std::uint8_t>(y * 255 / size.height),
                        static_cast<std::uint8_t>((x + y) * 255 / (size.width + size.height))};
    }
  }
  return image;
}

ColorImage noisy_color(ImageSize size) {
  std::mt19937 random(5);
  ColorImage image(size.width, size.height);
  for (Rgb8& pixel : image.pixels) {
    pixel = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  return image;
}

DepthImage ramp_depth(ImageSize size) {
  DepthImage image(size.width, size.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint16_t>(i * 257);
  return image;
}

template <class T>
T value(Result<T> result) {
  if (!result.ok()) throw std::runtime_error(result.error().message);
  return *std::move(result);
}

template <class T>
void expect_error(const Result<T>& result, ErrorCode code, const std::string& message) {
  ASSERT_FALSE(result.ok()) << "expected: " << message;
  EXPECT_STREQ(name_of(result.error().code), name_of(code));
  EXPECT_THAT(result.error().message, HasSubstr(message));
}

double psnr_db(const ColorImage& a, const ColorImage& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    squares += std::pow(a.pixels[i].r - b.pixels[i].r, 2) +
               std::pow(a.pixels[i].g - b.pixels[i].g, 2) +
               std::pow(a.pixels[i].b - b.pixels[i].b, 2);
  }
  return 10 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(a.pixels.size()) / squares);
}

// --- PNG made by hand, so that the headers can lie ---

void append_u32(Bytes& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

void append_chunk(Bytes& png, std::string_view type, const Bytes& data) {
  append_u32(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.insert(png.end(), type.begin(), type.end());
  png.insert(png.end(), data.begin(), data.end());
  append_u32(png, static_cast<std::uint32_t>(
                      crc32(0, png.data() + begin, static_cast<uInt>(png.size() - begin))));
}

Bytes deflated(const Bytes& raw) {
  uLongf size = compressBound(raw.size());
  Bytes packed(size);
  compress(packed.data(), &size, raw.data(), raw.size());
  packed.resize(size);
  return packed;
}

struct PngHeader {
  std::uint32_t width = 4, height = 2;
  std::uint8_t bit_depth = 8, color_type = 2;
};

Bytes png_start(const PngHeader& header) {
  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes data;
  append_u32(data, header.width);
  append_u32(data, header.height);
  data.insert(data.end(), {header.bit_depth, header.color_type, 0, 0, 0});
  append_chunk(png, "IHDR", data);
  return png;
}

Bytes handmade_png(const PngHeader& header, const Bytes& rows, const Bytes& palette = {}) {
  Bytes png = png_start(header);
  if (!palette.empty()) append_chunk(png, "PLTE", palette);
  append_chunk(png, "IDAT", deflated(rows));
  append_chunk(png, "IEND", {});
  return png;
}

// --- JPEG with other colour spaces than ours ---

Bytes turbo_jpeg(const Bytes& pixels, ImageSize size, int pixel_format, int subsampling,
                 int flags = 0) {
  tjhandle turbo = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long out_bytes = 0;
  EXPECT_EQ(tjCompress2(turbo, pixels.data(), size.width, 0, size.height, pixel_format, &out,
                        &out_bytes, subsampling, 90, flags),
            0);
  Bytes bytes(out, out + out_bytes);
  tjFree(out);
  tjDestroy(turbo);
  return bytes;
}

Bytes progressive_jpeg(ImageSize size) {
  const ColorImage image = smooth_color(size);
  const auto* begin = reinterpret_cast<const std::uint8_t*>(image.pixels.data());
  return turbo_jpeg(Bytes(begin, begin + image.pixels.size() * 3), size, TJPF_RGB, TJSAMP_420,
                    TJFLAG_PROGRESSIVE);
}

std::size_t find_marker(const Bytes& jpeg, std::uint8_t marker, std::size_t from = 0) {
  for (std::size_t i = from; i + 1 < jpeg.size(); ++i) {
    if (jpeg[i] == 0xff && jpeg[i + 1] == marker) return i;
  }
  return jpeg.size();
}

TEST(ImageCodec, DetectsFormatsByTheirFirstBytes) {
  EXPECT_EQ(value(detect_image_format(value(encode_jpeg(smooth_color(kSize), 90)))),
            ImageFormat::kJpeg);
  EXPECT_EQ(value(detect_image_format(value(encode_png(smooth_color(kSize))))), ImageFormat::kPng);
  expect_error(detect_image_format({}), ErrorCode::kUnsupported, "without bytes");
  expect_error(detect_image_format(Bytes{'G', 'I', 'F', '8', '9', 'a'}), ErrorCode::kUnsupported,
               "neither JPEG nor PNG");
  expect_error(detect_image_format(Bytes{0x89, 'P', 'N'}), ErrorCode::kUnsupported,
               "neither JPEG nor PNG");
}

TEST(ImageCodec, ReadsTheSizeFromTheHeaderAlone) {
  EXPECT_EQ(value(read_image_size(value(encode_jpeg(smooth_color(kSize), 90)))), kSize);
  EXPECT_EQ(value(read_image_size(png_start({.width = 640, .height = 480}))),
            (ImageSize{640, 480}));  // no pixels behind it
  expect_error(read_image_size({}), ErrorCode::kCorruptData, "without bytes");
  expect_error(read_image_size(Bytes{0xff, 0xd8, 0xff, 0xd9}), ErrorCode::kCorruptData, "JPEG: ");
  expect_error(read_image_size(Bytes{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}),
               ErrorCode::kCorruptData, "PNG: ");
  expect_error(read_image_size(png_start({.width = 0, .height = 480})), ErrorCode::kCorruptData,
               "PNG: ");
  expect_error(read_image_size(png_start({.width = 2147483647, .height = 2})), ErrorCode::kTooLarge,
               "the limit is 16384");
}

TEST(ImageCodec, ColorPngRoundTrips) {
  for (const ImageSize size : {kSize, ImageSize{1, 1}, ImageSize{1, 300}, ImageSize{300, 1}}) {
    const ColorImage image = noisy_color(size);
    EXPECT_TRUE(value(decode_color(value(encode_png(image)), size)) == image);
  }
}

TEST(ImageCodec, DepthPngRoundTripsEveryValue) {
  const DepthImage image = ramp_depth({256, 256});
  EXPECT_TRUE(value(decode_depth_png(value(encode_depth_png(image)), {256, 256})) == image);
}

TEST(ImageCodec, DepthPngIsBigEndianInTheFile) {
  const Bytes png = handmade_png({.width = 2, .height = 1, .bit_depth = 16, .color_type = 0},
                                 {0, 0x12, 0x34, 0xff, 0x00});
  const DepthImage depth = value(decode_depth_png(png, {2, 1}));
  EXPECT_EQ(depth.at(0, 0), 0x1234);
  EXPECT_EQ(depth.at(1, 0), 0xff00);
}

TEST(ImageCodec, JpegIsCloseAndDeterministic) {
  const ColorImage image = smooth_color({160, 120});
  const Bytes jpeg = value(encode_jpeg(image, 90));
  EXPECT_EQ(jpeg, value(encode_jpeg(image, 90)));
  const ColorImage decoded = value(decode_color(jpeg, {160, 120}));
  EXPECT_GT(psnr_db(image, decoded), 38.0);  // a smooth image at quality 90
  EXPECT_TRUE(decoded == value(decode_color(jpeg, {160, 120})));
  EXPECT_LT(value(encode_jpeg(image, 20)).size(), jpeg.size());
}

TEST(ImageCodec, ReadsEveryEightBitPng) {
  const Bytes grey = handmade_png({.width = 2, .height = 1, .color_type = 0}, {0, 10, 200});
  EXPECT_EQ(value(decode_color(grey, {2, 1})).pixels,
            (std::vector<Rgb8>{{10, 10, 10}, {200, 200, 200}}));
  const Bytes grey_alpha =
      handmade_png({.width = 2, .height = 1, .color_type = 4}, {0, 10, 0, 200, 7});
  EXPECT_EQ(value(decode_color(grey_alpha, {2, 1})).pixels,
            (std::vector<Rgb8>{{10, 10, 10}, {200, 200, 200}}));
  const Bytes rgba = handmade_png({.width = 1, .height = 1, .color_type = 6}, {0, 1, 2, 3, 0});
  EXPECT_EQ(value(decode_color(rgba, {1, 1})).pixels, (std::vector<Rgb8>{{1, 2, 3}}));
  const Bytes indexed =
      handmade_png({.width = 2, .height = 1, .color_type = 3}, {0, 1, 0}, {9, 8, 7, 6, 5, 4});
  EXPECT_EQ(value(decode_color(indexed, {2, 1})).pixels, (std::vector<Rgb8>{{6, 5, 4}, {9, 8, 7}}));
}

TEST(ImageCodec, ReadsGreyProgressiveAndFullColourJpeg) {
  const ImageSize size{32, 16};
  const ColorImage grey =
      value(decode_color(turbo_jpeg(Bytes(32 * 16, 77), size, TJPF_GRAY, TJSAMP_GRAY), size));
  EXPECT_EQ(grey.at(5, 5), (Rgb8{77, 77, 77}));
  EXPECT_TRUE(
      decode_color(turbo_jpeg(Bytes(32 * 16 * 3, 77), size, TJPF_RGB, TJSAMP_444), size).ok());
  EXPECT_TRUE(decode_color(progressive_jpeg(size), size).ok());
}

TEST(ImageCodec, RefusesOtherFormats) {
  const ImageSize size{4, 2};
  expect_error(decode_color({}, size), ErrorCode::kUnsupported, "without bytes");
  expect_error(decode_color(Bytes(100, 'x'), size), ErrorCode::kUnsupported,
               "neither JPEG nor PNG");
  expect_error(decode_color(turbo_jpeg(Bytes(4 * 2 * 4, 9), size, TJPF_CMYK, TJSAMP_444), size),
               ErrorCode::kUnsupported, "CMYK");
  expect_error(decode_color(value(encode_depth_png(ramp_depth(size))), size),
               ErrorCode::kUnsupported, "16 bits a channel, only 8");
  expect_error(decode_depth_png({}, size), ErrorCode::kUnsupported, "no PNG");
  expect_error(decode_depth_png(value(encode_jpeg(smooth_color(size), 90)), size),
               ErrorCode::kUnsupported, "no PNG");
  expect_error(decode_depth_png(value(encode_png(smooth_color(size))), size),
               ErrorCode::kUnsupported, "only 16-bit grey");
  const Bytes rgb16 = handmade_png({.bit_depth = 16, .color_type = 2}, Bytes(2 * (1 + 4 * 6), 0));
  expect_error(decode_depth_png(rgb16, size), ErrorCode::kUnsupported, "colour type 2 and 16 bits");
}

TEST(ImageCodec, RefusesOtherSizesNamingBoth) {
  const ImageSize other{kSize.width + 1, kSize.height};
  expect_error(decode_color(value(encode_jpeg(smooth_color(kSize), 90)), other),
               ErrorCode::kTooLarge, "JPEG of 61x43 pixels where 62x43 are expected");
  expect_error(decode_color(value(encode_png(smooth_color(kSize))), other), ErrorCode::kTooLarge,
               "PNG of 61x43 pixels where 62x43 are expected");
  expect_error(decode_depth_png(value(encode_depth_png(ramp_depth(kSize))), other),
               ErrorCode::kTooLarge, "61x43 pixels where 62x43");
}

TEST(ImageCodec, RefusesSizesThatAreNone) {
  const Bytes png = value(encode_png(smooth_color(kSize)));
  for (const ImageSize size :
       {ImageSize{0, 0}, ImageSize{-4, 5}, ImageSize{16385, 1}, ImageSize{1, 2147483647}}) {
    expect_error(decode_color(png, size), ErrorCode::kInvalidArgument, "1 to 16384 pixels an edge");
    expect_error(decode_depth_png(png, size), ErrorCode::kInvalidArgument,
                 "1 to 16384 pixels an edge");
  }
  expect_error(encode_png(ColorImage()), ErrorCode::kInvalidArgument, "0x0");
  expect_error(encode_depth_png(DepthImage()), ErrorCode::kInvalidArgument, "0x0");
  expect_error(encode_jpeg(ColorImage(), 90), ErrorCode::kInvalidArgument, "0x0");
  expect_error(encode_jpeg(smooth_color(kSize), 0), ErrorCode::kInvalidArgument, "quality 0");
  expect_error(encode_jpeg(smooth_color(kSize), 101), ErrorCode::kInvalidArgument, "quality 101");
}

TEST(ImageCodec, RefusesAnyCut) {
  const Bytes jpeg = value(encode_jpeg(noisy_color(kSize), 90)),
              progressive = progressive_jpeg(kSize), png = value(encode_png(noisy_color(kSize))),
              depth = value(encode_depth_png(ramp_depth(kSize)));
  const auto cut = [](const Bytes& whole, std::size_t missing) {
    return std::span<const std::uint8_t>(whole).first(whole.size() - missing);
  };
  for (const Bytes* whole : {&jpeg, &progressive, &png, &depth}) {
    // The last 4 bytes of a PNG are the checksum of its empty end chunk; libspng does without them,
    // and nothing of the image is lost.
    for (std::size_t missing = whole == &jpeg || whole == &progressive ? 1 : 5;
         missing <= whole->size(); missing += missing < 20 ? 1 : 50) {
      const auto part = cut(*whole, missing);
      const bool decoded =
          whole == &depth ? decode_depth_png(part, kSize).ok() : decode_color(part, kSize).ok();
      EXPECT_FALSE(decoded) << missing << " of " << whole->size() << " bytes cut";
    }
  }
}

TEST(ImageCodec, RefusesAnyFlippedBitOfAPng) {
  const Bytes color = value(encode_png(noisy_color({9, 7}))),
              depth = value(encode_depth_png(ramp_depth({9, 7})));
  for (const Bytes* whole : {&color, &depth}) {
    for (std::size_t bit = 0; bit < whole->size() * 8; ++bit) {
      Bytes flipped = *whole;
      flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1u << (bit % 8)));
      EXPECT_FALSE(decode_color(flipped, {9, 7}).ok()) << "bit " << bit;
      EXPECT_FALSE(decode_depth_png(flipped, {9, 7}).ok()) << "bit " << bit;
    }
  }
}

TEST(ImageCodec, SurvivesFlippedBitsOfAJpeg) {
  // JPEG has no checksum: some flips only change pixels. None may do more than that.
  const Bytes baseline = value(encode_jpeg(noisy_color(kSize), 75)),
              progressive = progressive_jpeg(kSize);
  int refused = 0;
  for (const Bytes* whole : {&baseline, &progressive}) {
    for (std::size_t bit = 0; bit < whole->size() * 8; bit += 3) {
      Bytes flipped = *whole;
      flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1u << (bit % 8)));
      const Result<ColorImage> decoded = decode_color(flipped, kSize);
      if (decoded.ok()) {
        EXPECT_EQ(decoded->pixels.size(), 61u * 43u);
      } else {
        EXPECT_FALSE(decoded.error().message.empty());
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500);
}

TEST(ImageCodec, RefusesAJpegThatHoldsFewerPixelsThanItSays) {
  Bytes jpeg = value(encode_jpeg(smooth_color({64, 64}), 90));
  const std::size_t frame = find_marker(jpeg, 0xc0);
  ASSERT_LT(frame + 8, jpeg.size());
  jpeg[frame + 5] = 4;  // height 64 -> 1088
  expect_error(decode_color(jpeg, {64, 64}), ErrorCode::kTooLarge,
               "JPEG of 64x1088 pixels where 64x64 are expected");
  expect_error(decode_color(jpeg, {64, 1088}), ErrorCode::kCorruptData, "JPEG: ");
}

TEST(ImageCodec, BoundsTheWorkOfAProgressiveJpeg) {
  // The last scan of a progressive JPEG, repeated: a few bytes each, a pass over the whole image
  // each.
  Bytes jpeg = progressive_jpeg({640, 480});
  std::size_t last = 0;
  for (std::size_t at = find_marker(jpeg, 0xda); at < jpeg.size();
       at = find_marker(jpeg, 0xda, at + 2))
    last = at;
  const Bytes scan(jpeg.begin() + static_cast<std::ptrdiff_t>(last), jpeg.end() - 2);
  for (int i = 0; i < 400; ++i) jpeg.insert(jpeg.end() - 2, scan.begin(), scan.end());
  expect_error(decode_color(jpeg, {640, 480}), ErrorCode::kTooLarge, "scans, the limit is 32");
}

TEST(ImageCodec, RefusesBombsBeforeTheyTakeMemory) {
  const ImageSize size{64, 48};
  Bytes wide = png_start({.width = 16384, .height = 16384});  // 800 MB of pixels
  append_chunk(wide, "IDAT", deflated(Bytes(1 << 20, 0)));
  const Bytes wider = png_start({.width = 2147483647, .height = 2147483647});
  Bytes huge_jpeg = value(encode_jpeg(smooth_color(size), 90));
  const std::size_t frame = find_marker(huge_jpeg, 0xc0);
  std::memset(&huge_jpeg[frame + 5], 0x3f, 4);  // 16191x16191
  // The right size, and 64 MB of zeros where 9 kB belong.
  const Bytes long_data = handmade_png({.width = 64, .height = 48}, Bytes(64 << 20, 0));
  // A colour profile of 64 MB in 64 kB.
  Bytes profile = {'x', 0, 0};
  const Bytes packed = deflated(Bytes(64 << 20, 0));
  profile.insert(profile.end(), packed.begin(), packed.end());
  Bytes profile_png = png_start({.width = 64, .height = 48});
  append_chunk(profile_png, "iCCP", profile);
  append_chunk(profile_png, "IDAT", deflated(Bytes(48 * (1 + 64 * 3), 0)));
  append_chunk(profile_png, "IEND", {});

  const std::size_t growth_bytes = test::peak_growth_bytes([&] {
    expect_error(decode_color(wide, size), ErrorCode::kTooLarge, "16384x16384 pixels where 64x48");
    expect_error(decode_color(wider, size), ErrorCode::kTooLarge, "the limit is 16384");
    expect_error(decode_depth_png(wide, size), ErrorCode::kTooLarge,
                 "16384x16384 pixels where 64x48");
    expect_error(decode_color(huge_jpeg, size), ErrorCode::kTooLarge,
                 "16191x16191 pixels where 64x48");
    (void)decode_color(long_data, size);
    expect_error(decode_color(profile_png, size), ErrorCode::kTooLarge, "metadata");
  });
  EXPECT_LT(growth_bytes, 12u << 20);
}

TEST(ImageCodec, ReadsRecordedImages) {
  const auto folder = test::data_folder("redkitchen");
  if (!folder) GTEST_SKIP() << test::skip_message("redkitchen");
  for (int frame = 0; frame < 1000; frame += 25) {
    char name[32];
    std::snprintf(name, sizeof(name), "frame-%06d", frame);
    const Bytes color_bytes = test::file_bytes(*folder / (std::string(name) + ".color.jpg"));
    EXPECT_EQ(value(read_image_size(color_bytes)), (ImageSize{640, 480}));
    const Result<ColorImage> color = decode_color(color_bytes, {640, 480});
    EXPECT_TRUE(color.ok()) << name << ": " << color.error().message;
    const Result<DepthImage> depth = decode_depth_png(
        test::file_bytes(*folder / (std::string(name) + ".depth.png")), {640, 480});
    ASSERT_TRUE(depth.ok()) << name << ": " << depth.error().message;
    EXPECT_TRUE(value(decode_depth_png(value(encode_depth_png(*depth)), {640, 480})) == *depth);
  }
}

}  // namespace
}  // namespace hermite::image
