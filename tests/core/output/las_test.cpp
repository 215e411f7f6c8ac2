// Offsets are those of the tables of the LAS 1.4 R15 specification.
#include "core/output/las.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

template <class Value>
Value las_value(const std::string& las, std::size_t at) {
  Value value{};
  EXPECT_LE(at + sizeof value, las.size());
  std::memcpy(&value, las.data() + at, sizeof value);
  return value;
}

Cloud three_points() {
  Cloud cloud(3);
  cloud[0].position_m = {-1.25f, 0.5f, 3};
  cloud[1] = {
      {1.5f, -2.25f, 3.125f}, {0, 0.6f, -0.8f}, {10, 20, 255}, 12.5f, 40, -3, 0.004f, 70000};
  cloud[2].position_m = {0, 0, 1e-4f};
  return cloud;
}

TEST(Las, HeaderSaysWhereEverythingIs) {
  const Result<std::string> las = format_las(three_points());
  ASSERT_TRUE(las.ok()) << las.error().message;
  EXPECT_EQ(las->substr(0, 4), "LASF");
  EXPECT_EQ(las_value<std::uint16_t>(*las, 6), 16) << "the coordinate system is WKT";
  EXPECT_EQ(las_value<std::uint8_t>(*las, 24), 1);
  EXPECT_EQ(las_value<std::uint8_t>(*las, 25), 4);
  EXPECT_EQ(las_value<std::uint16_t>(*las, 94), 375);
  EXPECT_EQ(las_value<std::uint32_t>(*las, 100), 2u);
  EXPECT_EQ(las_value<std::uint8_t>(*las, 104), 7);
  EXPECT_EQ(las_value<std::uint16_t>(*las, 105), 36 + 32);
  EXPECT_EQ(las_value<std::uint32_t>(*las, 107), 0u) << "the count of old";
  EXPECT_EQ(las_value<double>(*las, 131), 0.0001);
  EXPECT_EQ(las_value<std::uint64_t>(*las, 247), 3u);
  EXPECT_EQ(las_value<std::uint64_t>(*las, 255), 3u);
  EXPECT_EQ(las->size(), las_value<std::uint32_t>(*las, 96) + 3 * 68u);
  // Right, forward, up: x, z and -y of the scan. Each axis: max, min.
  EXPECT_NEAR(las_value<double>(*las, 179), 1.5, 5e-5);
  EXPECT_NEAR(las_value<double>(*las, 187), -1.25, 5e-5);
  EXPECT_NEAR(las_value<double>(*las, 195), 3.125, 5e-5);
  EXPECT_NEAR(las_value<double>(*las, 203), 0.0001, 5e-5);
  EXPECT_NEAR(las_value<double>(*las, 211), 2.25, 5e-5);
  EXPECT_NEAR(las_value<double>(*las, 219), -0.5, 5e-5);
}

TEST(Las, PointsReadBackWithinHalfAStep) {
  const Cloud cloud = three_points();
  const std::string las = *format_las(cloud);
  const std::size_t first = las_value<std::uint32_t>(las, 96);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const auto offset = static_cast<std::size_t>(8 * axis);
      const double value = las_value<std::int32_t>(las, first + 68 * i + offset / 2) *
                               las_value<double>(las, 131 + offset) +
                           las_value<double>(las, 155 + offset);
      const Eigen::Vector3f& position = cloud[i].position_m;
      const float expected = axis == 0 ? position.x() : axis == 1 ? position.z() : -position.y();
      EXPECT_NEAR(value, static_cast<double>(expected), 5.1e-5);
    }
  const std::size_t second = first + 68;
  EXPECT_EQ(las_value<std::uint8_t>(las, second + 14), 0x11);
  EXPECT_EQ(las_value<std::uint16_t>(las, second + 30), 2570);
  EXPECT_EQ(las_value<std::uint16_t>(las, second + 32), 5140);
  EXPECT_EQ(las_value<std::uint16_t>(las, second + 34), 65535);
  EXPECT_EQ(las_value<float>(las, second + 36), 0.0f);
  EXPECT_EQ(las_value<float>(las, second + 40), -0.8f);
  EXPECT_EQ(las_value<float>(las, second + 44), -0.6f);
  EXPECT_EQ(las_value<float>(las, second + 48), 12.5f);
  EXPECT_EQ(las_value<float>(las, second + 52), 40.0f);
  EXPECT_EQ(las_value<float>(las, second + 56), -3.0f);
  EXPECT_EQ(las_value<float>(las, second + 60), 0.004f);
  EXPECT_EQ(las_value<std::uint32_t>(las, second + 64), 70000u);
}

TEST(Las, RecordsDescribeTheColumnsAndTheCoordinates) {
  const std::string las = *format_las(three_points());
  const std::size_t wkt = 375, wkt_size = las_value<std::uint16_t>(las, wkt + 20);
  EXPECT_EQ(std::string(las.c_str() + wkt + 2), "LASF_Projection");
  EXPECT_EQ(las_value<std::uint16_t>(las, wkt + 18), 2112);
  EXPECT_EQ(las.substr(wkt + 54, 10), "LOCAL_CS[\"");
  EXPECT_EQ(las[wkt + 54 + wkt_size - 1], '\0');
  const std::size_t extra = wkt + 54 + wkt_size;
  EXPECT_EQ(std::string(las.c_str() + extra + 2), "LASF_Spec");
  EXPECT_EQ(las_value<std::uint16_t>(las, extra + 18), 4);
  EXPECT_EQ(las_value<std::uint16_t>(las, extra + 20), 8 * 192);
  EXPECT_EQ(las_value<std::uint8_t>(las, extra + 54 + 2), 9);
  EXPECT_EQ(std::string(las.c_str() + extra + 54 + 4), "NormalX");
  EXPECT_EQ(las_value<std::uint8_t>(las, extra + 54 + 7 * 192 + 2), 5);
  EXPECT_EQ(std::string(las.c_str() + extra + 54 + 7 * 192 + 4), "Submap");
  EXPECT_EQ(std::string(las.c_str() + extra + 54 + 7 * 192 + 160), "part that moves as one");
  EXPECT_EQ(extra + 54 + 8 * 192, las_value<std::uint32_t>(las, 96));
}

TEST(Las, FarAwayIsExactToo) {
  Cloud cloud(2);
  cloud[0].position_m = {1e6f, 0, -5e6f};
  cloud[1].position_m = {1e6f + 1, 0, -5e6f};
  const std::string las = *format_las(cloud);
  EXPECT_EQ(las_value<double>(las, 155), 1e6);
  EXPECT_EQ(las_value<std::int32_t>(las, las_value<std::uint32_t>(las, 96) + 68), 10000);
}

TEST(Las, WhatItCannotHoldIsRefused) {
  Cloud cloud = three_points();
  cloud[1].position_m.x() = 3e5f;
  EXPECT_EQ(format_las(cloud).error().code, ErrorCode::kTooLarge);
  cloud[1].position_m.x() = std::nanf("");
  EXPECT_THAT(format_las(cloud).error().message, HasSubstr("point 1 of 3"));
  EXPECT_THAT(format_las({}).error().message, HasSubstr("no point"));
}

}  // namespace
}  // namespace hermite::output
