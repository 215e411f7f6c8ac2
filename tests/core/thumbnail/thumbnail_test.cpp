#include "core/thumbnail/thumbnail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/image/image_codec.h"

namespace hermite::thumbnail {
namespace {
namespace thumbnail_test {

constexpr Rgb8 kFloor{200, 30, 30}, kWall{30, 200, 30}, kCeiling{30, 30, 200};

// A room of 4 x 3 m, 2.4 m high, seen from its middle by a camera that looks at one of its walls.
output::Cloud room() {
  output::Cloud cloud;
  const auto add = [&cloud](const Eigen::Vector3f& position_m, const Eigen::Vector3f& normal,
                            Rgb8 color) {
    output::CloudPoint point;
    point.position_m = position_m;
    point.normal = normal;
    point.color = color;
    point.radius_m = 0.03f;
    cloud.push_back(point);
  };
  for (float x = -2; x <= 2; x += 0.04f) {
    for (float z = -1.5f; z <= 1.5f; z += 0.04f) {
      add({x, 1.2f, z}, {0, -1, 0}, kFloor);
      add({x, -1.2f, z}, {0, 1, 0}, kCeiling);
    }
    for (float y = -1.2f; y <= 1.2f; y += 0.04f) {
      add({x, y, 1.5f}, {0, 0, -1}, kWall);
      add({x, y, -1.5f}, {0, 0, 1}, kWall);
    }
  }
  for (float z = -1.5f; z <= 1.5f; z += 0.04f)
    for (float y = -1.2f; y <= 1.2f; y += 0.04f) {
      add({-2, y, z}, {1, 0, 0}, kWall);
      add({2, y, z}, {-1, 0, 0}, kWall);
    }
  return cloud;
}

struct Shares {
  double floor = 0, walls = 0, ceiling = 0;
};

Shares shares_of(const ColorImage& image) {
  Shares shares;
  for (const Rgb8& pixel : image.pixels) {
    const double one = 1.0 / static_cast<double>(image.pixels.size());
    if (pixel.r > 80 && pixel.g < 60) shares.floor += one;
    if (pixel.g > 80 && pixel.r < 60) shares.walls += one;
    if (pixel.b > 80 && pixel.r < 60 && pixel.g < 60) shares.ceiling += one;
  }
  return shares;
}

TEST(Thumbnail, OfAClosedRoomShowsItsInside) {
  const ColorImage image = thumbnail_of(room());
  ASSERT_EQ(image.width, kThumbnailWidth_px);
  ASSERT_EQ(image.height, kThumbnailHeight_px);
  const Shares shares = shares_of(image);
  EXPECT_GT(shares.floor, 0.1);
  EXPECT_GT(shares.walls, 0.1);
  EXPECT_EQ(shares.ceiling, 0);
  EXPECT_GT(shares.floor + shares.walls, 0.35);  // it fills the image
}

TEST(Thumbnail, IsTheSameAgain) { EXPECT_EQ(thumbnail_of(room()), thumbnail_of(room())); }

TEST(Thumbnail, AStrayPointDoesNotMakeItSmall) {
  output::Cloud cloud = room();
  cloud.push_back(cloud.front());
  cloud.back().position_m = {200, 0, 200};
  cloud.push_back(cloud.front());
  cloud.back().position_m.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_GT(shares_of(thumbnail_of(cloud)).floor, 0.1);
}

TEST(Thumbnail, OfPointsThatHaveNothingButPositionsShowsThem) {
  output::Cloud cloud = room();
  for (output::CloudPoint& point : cloud) {
    point.normal.setZero();
    point.radius_m = 0;
    point.color = {250, 250, 250};
  }
  std::size_t bright = 0;
  for (const Rgb8& pixel : thumbnail_of(cloud).pixels) bright += pixel.r > 150 ? 1 : 0;
  EXPECT_GT(bright, 0.3 * kThumbnailWidth_px * kThumbnailHeight_px);
}

TEST(Thumbnail, OfNothingOrOnePointIsAnImage) {
  output::CloudPoint point;
  point.color = {255, 255, 255};
  for (const output::Cloud& cloud : {output::Cloud{}, output::Cloud{point}}) {
    const Result<std::string> jpeg = thumbnail_jpeg(cloud);
    ASSERT_TRUE(jpeg.ok()) << jpeg.error().message;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(jpeg->data());
    EXPECT_TRUE(
        image::decode_color({bytes, jpeg->size()}, {kThumbnailWidth_px, kThumbnailHeight_px}).ok());
  }
}

}  // namespace thumbnail_test
}  // namespace
}  // namespace hermite::thumbnail
