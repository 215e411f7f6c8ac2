#include "core/output/ply_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/output/ply.h"

namespace hermite::output {
namespace ply_points_test {

struct Read {
  std::vector<CloudPoint> points;
  Status status = Done{};
};

Read read_all(const std::string& bytes) {
  Read read;
  read.status = for_each_ply_point(
      [&](std::uint64_t offset, std::size_t max_bytes) -> Result<std::string> {
        return offset < bytes.size() ? bytes.substr(offset, max_bytes) : std::string();
      },
      [&](const CloudPoint& point) { read.points.push_back(point); });
  return read;
}

TEST(PlyPoints, WhatWasWrittenIsReadInItsOrder) {
  Cloud cloud(70'000);  // more than a piece
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].position_m = {static_cast<float>(i), 2, -3};
    cloud[i].normal = {0, 0.6f, -0.8f};
    cloud[i].color = {1, 2, 3};
    cloud[i].confidence = 7;
    cloud[i].curvature_max_per_m = 8;
    cloud[i].curvature_min_per_m = -9;
    cloud[i].radius_m = 0.01f;
    cloud[i].submap = 4'000'000'000;
  }
  const Read read = read_all(format_ply(cloud));
  ASSERT_TRUE(read.status.ok()) << read.status.error().message;
  ASSERT_EQ(read.points.size(), cloud.size());
  EXPECT_EQ(format_ply(read.points), format_ply(cloud));
  EXPECT_TRUE(read_all(format_ply({})).status.ok());
}

TEST(PlyPoints, WhatIsCutOrOfAnotherProgramIsRefused) {
  const std::string bytes = format_ply(Cloud(3));
  for (const std::size_t length :
       {bytes.size() - 1, bytes.size() - 100, std::size_t{40}, std::size_t{0}})
    EXPECT_FALSE(read_all(bytes.substr(0, length)).status.ok()) << length;
  std::string huge = bytes;
  huge.replace(huge.find("vertex 3"), 8, "vertex 9999999999999999999");
  EXPECT_FALSE(read_all(huge).status.ok());
  EXPECT_EQ(read_all("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n").status.error().code,
            ErrorCode::kUnsupported);
}

}  // namespace ply_points_test
}  // namespace hermite::output
