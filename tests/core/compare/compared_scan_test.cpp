#include "core/compare/compared_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/core/compare/made_corner.h"

namespace hermite::compare::compared_scan_test {

using ::testing::HasSubstr;

std::string error_of(output::Cloud cloud) {
  const Result<ComparedScan> scan = ComparedScan::create(std::move(cloud), {}, "the first scan");
  return scan.ok() ? "" : scan.error().message;
}

TEST(ComparedScan, PointsThatAreNoneAreLeftOutAndCounted) {
  output::Cloud cloud = test::corner_cloud(test::usual_boxes());
  const std::size_t count = cloud.size();
  cloud[3].position_m.x() = std::numeric_limits<float>::quiet_NaN();
  cloud[5].normal.setZero();
  cloud[7].normal.y() = std::numeric_limits<float>::infinity();
  cloud[9].normal *= 3;
  const Result<ComparedScan> scan = ComparedScan::create(cloud, {}, "scan");
  ASSERT_TRUE(scan.ok()) << scan.error().message;
  EXPECT_EQ(scan->left_out_count(), 3u);
  EXPECT_EQ(scan->surfels().size(), count - 3);
  EXPECT_TRUE(scan->has_color());
  for (const output::CloudPoint& point : scan->surfels()) EXPECT_NEAR(point.normal.norm(), 1, 1e-5);
}

TEST(ComparedScan, TooFewPointsAndOtherUnitsAreRefusedWithAMessage) {
  EXPECT_THAT(error_of({}), HasSubstr("the first scan: it has 0 usable points with normals"));
  output::Cloud cloud = test::corner_cloud(test::usual_boxes());
  for (output::CloudPoint& point : cloud) point.position_m *= 1000;
  EXPECT_THAT(error_of(cloud), HasSubstr("positions must be in metres"));
  for (output::CloudPoint& point : cloud) point.position_m *= 1e-5f;
  EXPECT_THAT(error_of(cloud), HasSubstr("positions must be in metres"));
  cloud = test::corner_cloud(test::usual_boxes());
  cloud.front().position_m = {3e9f, 0, 0};
  EXPECT_THAT(error_of(cloud), HasSubstr("from the origin"));
}

TEST(ComparedScan, WithoutConfidencesAllPointsCountAlike) {
  output::Cloud cloud = test::corner_cloud(test::usual_boxes());
  for (output::CloudPoint& point : cloud) point.confidence = 0;
  EXPECT_EQ(or_throw(ComparedScan::create(cloud, {}, "scan")).surfels().front().confidence, 1);
  cloud[1].confidence = 2;
  EXPECT_EQ(or_throw(ComparedScan::create(cloud, {}, "scan")).surfels().front().confidence, 0);
}

TEST(ComparedScan, SamplesCoverTheSurfaceAndBothSidesOfIt) {
  output::Cloud cloud;
  for (int side : {-1, 1})
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 40; ++j) {
        output::CloudPoint point;
        point.position_m = {0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), 0.001f};
        point.normal = {0, 0, static_cast<float>(side)};
        cloud.push_back(point);
      }
  const SurfaceSamples samples = surface_samples(cloud, 0.05, 1000);
  EXPECT_EQ(samples.samples.size(), 2 * 8u * 8u);
  EXPECT_EQ(samples.of_surfel.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_EQ(samples.samples[samples.of_surfel[i]].normal.z(), double{cloud[i].normal.z()});
  const SurfaceSamples fewer = surface_samples(cloud, 0.05, 50);
  EXPECT_LE(fewer.samples.size(), 50u);
  EXPECT_GT(fewer.spacing_m, 0.05);
}

}  // namespace hermite::compare::compared_scan_test
