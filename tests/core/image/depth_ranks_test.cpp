#include "core/image/depth_ranks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "core/image/depth_codec.h"
#include "tests/support/data_folder.h"
#include "tests/support/depth_pattern.h"
#include "tests/support/memory_peak.h"
#include "tests/support/recorded_depth.h"

namespace hermite::image {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

// A slanted surface with steps, holes and noise; `quantised` to disparities as structured light
// gives them.
DepthImage sensor_like(ImageSize size, unsigned seed, bool quantised) {
  std::mt19937 random(seed);
  return test::make_depth(size, [&](std::size_t i) {
    const std::size_t x = i % static_cast<std::size_t>(size.width),
                      y = i / static_cast<std::size_t>(size.width);
    if (x % 97 < 5 || random() % 200 == 0) return std::uint16_t{0};
    const double depth_mm =
        900 + 3.0 * static_cast<double>(x) + static_cast<double>(y) + (x / 50 % 2 == 0 ? 0 : 1500);
    const double noise = static_cast<double>(random() % 1000) / 1000 - 0.5;
    if (!quantised) return static_cast<std::uint16_t>(depth_mm + 8 * noise);
    return static_cast<std::uint16_t>(std::lround(350000 / std::round(350000 / depth_mm + noise)));
  });
}

void expect_same_after_ranks(const DepthImage& depth) {
  const Bytes bytes = encode_depth_ranks(depth);
  EXPECT_LE(bytes.size(), max_depth_ranks_bytes(depth.pixels.size()));
  const Result<DepthImage> decoded = decode_depth_ranks(bytes, {depth.width, depth.height});
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_TRUE(*decoded == depth);
}

void expect_ranks_refused(const Bytes& bytes, ImageSize expected, ErrorCode code,
                          const std::string& message) {
  const Result<DepthImage> decoded = decode_depth_ranks(bytes, expected);
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(name_of(decoded.error().code), std::string(name_of(code)));
  EXPECT_THAT(decoded.error().message, HasSubstr(message));
}

TEST(DepthRanks, RoundTripsPathologicalImages) {
  const ImageSize size{320, 241};
  std::mt19937 random(1);
  const std::vector<std::function<std::uint16_t(std::size_t)>> patterns = {
      [](std::size_t) { return 0; },
      [](std::size_t) { return 1; },
      [](std::size_t) { return 65535; },
      [](std::size_t i) { return static_cast<std::uint16_t>(i % 2 * 65535); },
      // The largest differences, both ways.
      [](std::size_t i) { return static_cast<std::uint16_t>(i % 2 == 0 ? 1 : 65535); },
      // Every value.
      [](std::size_t i) { return static_cast<std::uint16_t>(i); },
      [](std::size_t i) { return static_cast<std::uint16_t>(65535 - i % 65536); },
      [](std::size_t i) { return static_cast<std::uint16_t>(i == 0 ? 40000 : 0); },
      [](std::size_t i) { return static_cast<std::uint16_t>(i == 320 * 241 - 1 ? 40000 : 0); },
      [&](std::size_t) { return static_cast<std::uint16_t>(random()); },
      [&](std::size_t i) {
        return static_cast<std::uint16_t>(i % 7 == 0 ? 0 : 1 + random() % 65535);
      },
  };
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same_after_ranks(test::make_depth(size, patterns[i]));
  }
}

TEST(DepthRanks, RoundTripsRandomImagesOfAllSizes) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(trial);
    const ImageSize size{1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 40)};
    const auto value_bits = 1 + random() % 16, zero_share = random() % 5, step = 1 + random() % 9;
    expect_same_after_ranks(test::make_depth(size, [&](std::size_t) {
      return random() % 4 < zero_share
                 ? std::uint16_t{0}
                 : static_cast<std::uint16_t>((random() & ((1u << value_bits) - 1u)) / step * step);
    }));
  }
}

TEST(DepthRanks, RoundTripsASinglePixelOfAnyValue) {
  for (const int value : {0, 1, 2, 255, 40000, 65534, 65535})
    expect_same_after_ranks(test::make_depth({1, 1}, [&](std::size_t) { return value; }));
}

TEST(DepthRanks, RoundTripsBothKindsOfSensor) {
  for (const bool quantised : {true, false})
    expect_same_after_ranks(sensor_like({640, 480}, 3, quantised));
}

TEST(DepthRanks, IsSmallerThanRvlOnBothKindsOfSensor) {
  const DepthImage structured_light = sensor_like({640, 480}, 4, true),
                   time_of_flight = sensor_like({640, 480}, 4, false);
  EXPECT_LT(encode_depth_ranks(structured_light).size(),
            encode_depth_rvl_zstd(structured_light).size() * 6 / 10);
  EXPECT_LT(encode_depth_ranks(time_of_flight).size(),
            encode_depth_rvl_zstd(time_of_flight).size());
}

TEST(DepthRanks, AnEmptyImageTakesNextToNothing) {
  EXPECT_LT(encode_depth_ranks(DepthImage(640, 480)).size(), 32u);
}

// FNV-1a: a few digits for many bytes.
std::uint32_t digest(const Bytes& bytes) {
  std::uint32_t sum = 0x811c9dc5;
  for (const std::uint8_t byte : bytes) sum = (sum ^ byte) * 0x01000193;
  return sum;
}

// Another machine, compiler or version must write the same.
TEST(DepthRanks, WritesTheSameBytesForEver) {
  DepthImage depth(4, 2);
  depth.pixels = {0, 0, 500, 700, 500, 500, 700, 0};
  EXPECT_EQ(encode_depth_ranks(depth),
            (Bytes{0x5e, 0xe7, 0x11, 0xd2, 0x06, 0x20, 0x00, 0x20, 0x05, 0x20, 0x00, 0x03, 0x08,
                   0x20, 0x80, 0x00, 0x40, 0x07, 0x40, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                   0x00, 0x66, 0x14, 0x10, 0x12, 0x66, 0x04, 0x04, 0x00, 0x04, 0x00, 0x01, 0x00}));
  std::mt19937 random(13);
  const auto slanted = [&](std::size_t i) {
    return static_cast<std::uint16_t>(i % 19 == 0 ? 0 : (700 + i / 7 % 50 + random() % 5));
  };
  EXPECT_EQ(digest(encode_depth_ranks(test::make_depth({97, 61}, slanted))), 25225475u);
  EXPECT_EQ(
      digest(encode_depth_ranks(test::make_depth(
          {97, 61}, [&](std::size_t i) { return static_cast<std::uint16_t>(9 * slanted(i)); }))),
      2880315120u);
}

TEST(DepthRanks, RefusesAnyCutOrFlippedBit) {
  const ImageSize size{24, 17};
  for (const bool quantised : {true, false}) {
    const Bytes whole = encode_depth_ranks(sensor_like(size, 2, quantised));
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const Result<DepthImage> decoded = decode_depth_ranks({whole.data(), length}, size);
      ASSERT_FALSE(decoded.ok()) << "cut to " << length << " of " << whole.size() << " bytes";
      EXPECT_THAT(decoded.error().message, HasSubstr("depth: "));
    }
    for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1u << (bit % 8)));
      EXPECT_FALSE(decode_depth_ranks(flipped, size).ok()) << "bit " << bit;
    }
    for (const int tail : {0, 1, 255}) {
      Bytes longer = whole;
      longer.push_back(static_cast<std::uint8_t>(tail));
      EXPECT_FALSE(decode_depth_ranks(longer, size).ok()) << "a byte " << tail << " more";
    }
  }
}

TEST(DepthRanks, RefusesAnotherSize) {
  const Bytes bytes = encode_depth_ranks(sensor_like({20, 10}, 4, true));
  for (const ImageSize size :
       {ImageSize{20, 9}, ImageSize{20, 11}, ImageSize{10, 20}, ImageSize{1, 1}})
    EXPECT_FALSE(decode_depth_ranks(bytes, size).ok()) << size.width << "x" << size.height;
  expect_ranks_refused(bytes, {0, 10}, ErrorCode::kInvalidArgument, "image size 0x10");
  expect_ranks_refused(bytes, {kMaxImageEdge_px + 1, 1}, ErrorCode::kInvalidArgument,
                       "1 to 16384 pixels an edge");
  expect_ranks_refused(Bytes(max_depth_ranks_bytes(200) + 1), {20, 10}, ErrorCode::kTooLarge,
                       "33569 bytes, the limit for this image is 33568");
}

TEST(DepthRanks, TakesTheMemoryOfTheExpectedImageWhateverTheBytes) {
  const Bytes bomb = encode_depth_ranks(DepthImage(4096, 4096));  // 32 MiB in a few bytes
  ASSERT_LT(bomb.size(), 64u);
  EXPECT_LT(test::peak_growth_bytes([&] {
              EXPECT_FALSE(decode_depth_ranks(bomb, {64, 48}).ok());
            }),
            8u << 20);
}

TEST(DepthRanks, SurvivesNoise) {
  std::mt19937 random(11);
  const ImageSize size{32, 24};
  const Bytes good = encode_depth_ranks(sensor_like(size, 5, true));
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes = good;
    if (trial % 2 == 0) {
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    } else {  // some bytes changed, mostly in the header
      for (int i = 0; i < 3; ++i)
        bytes[random() % (i == 0 ? bytes.size() : 100)] = static_cast<std::uint8_t>(random());
    }
    const Result<DepthImage> decoded = decode_depth_ranks(bytes, size);
    EXPECT_TRUE(!decoded.ok() || bytes == good);
  }
}

TEST(DepthRanks, KeepsRecordedDepth) {
  const auto folder = test::data_folder("redkitchen");
  if (!folder) GTEST_SKIP() << test::skip_message("redkitchen");
  const std::vector<DepthImage> images = test::recorded_depth(*folder);
  std::size_t encoded_bytes = 0;
  for (const DepthImage& depth : images) {
    expect_same_after_ranks(depth);
    encoded_bytes += encode_depth_ranks(depth).size();
  }
  const double bits_per_pixel = 8.0 * static_cast<double>(encoded_bytes) /
                                (640.0 * 480.0 * static_cast<double>(images.size()));
  RecordProperty("bits_per_pixel", std::to_string(bits_per_pixel));
  // 0.78 measured for a Kinect v1: more means that the codec has lost its way.
  EXPECT_LT(bits_per_pixel, 0.85);
}

}  // namespace
}  // namespace hermite::image
