#include "core/compare/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/compare/compare_output.h"
#include "core/output/ply_reader.h"
#include "tests/core/compare/made_corner.h"

namespace hermite::compare::compare_test {

using ::testing::HasSubstr;

// The first box was pushed 20 mm along x, the second taken away, and another put down.
std::vector<test::MadeBox> changed_boxes() {
  std::vector<test::MadeBox> boxes = test::usual_boxes();
  boxes[0].low_m.x() += 0.02;
  boxes[0].high_m.x() += 0.02;
  boxes[1] = {{0.55, 0.35, 0}, {0.67, 0.47, 0.15}, {120, 60, 150}};
  return boxes;
}

double area_of(const Comparison& comparison, RegionKind kind) {
  double area_m2 = 0;
  for (const ChangedRegion& region : comparison.regions)
    area_m2 += region.kind == kind ? region.area_m2 : 0;
  return area_m2;
}

const Comparison& changed() {
  static const Comparison comparison = or_throw(
      compare_scans(test::corner_scan(test::usual_boxes(), 1),
                    test::corner_scan(changed_boxes(), 2, test::elsewhere()), ChangeOptions()));
  return comparison;
}

TEST(Compare, FindsWhatWasMovedRemovedAndAdded) {
  ASSERT_EQ(changed().registration.verdict, RegistrationVerdict::kSamePlace)
      << changed().registration.message;
  const Vector6d error = log_se3(changed().registration.alignment.a_from_b * test::elsewhere());
  EXPECT_LT(error.head<3>().norm(), 0.001);
  EXPECT_LT(error.tail<3>().norm(), 0.002);
  // Two sides of 0.20 x 0.22 m moved, one towards its outside, one away.
  EXPECT_NEAR(area_of(changed(), RegionKind::kMovedTowards), 0.044, 0.015);
  EXPECT_NEAR(area_of(changed(), RegionKind::kMovedAway), 0.044, 0.025);
  for (const ChangedRegion& region : changed().regions)
    if (region.kind == RegionKind::kMovedTowards) {
      EXPECT_NEAR(region.mean_distance_m, 0.02, 2 * region.sigma_m + 0.001);
      EXPECT_NEAR(region.high_m.x(), 0.40, 0.01) << "in the first scan's world, where it was";
    }
  EXPECT_GT(area_of(changed(), RegionKind::kRemoved), 0.15)
      << "all sides that were seen, and the top";
  EXPECT_GT(area_of(changed(), RegionKind::kAdded), 0.04);
}

TEST(Compare, TheSameScanTwiceHasNoChanges) {
  const ComparedScan scan = test::corner_scan(test::usual_boxes());
  const Comparison comparison = or_throw(compare_scans(scan, scan, ChangeOptions()));
  ASSERT_EQ(comparison.registration.verdict, RegistrationVerdict::kSamePlace)
      << comparison.registration.message;
  EXPECT_LT(log_se3(comparison.registration.alignment.a_from_b).norm(), 1e-4);
  EXPECT_TRUE(comparison.regions.empty());
  EXPECT_GT(comparison.compared_area_m2, 1.5);
}

TEST(Compare, WithoutPathsNothingIsCalledRemovedOrAdded) {
  const auto plain = [](const std::vector<test::MadeBox>& boxes, unsigned seed) {
    return or_throw(ComparedScan::create(test::corner_cloud(boxes, seed), {}, "scan"));
  };
  const Comparison comparison = or_throw(
      compare_scans(plain(test::usual_boxes(), 1), plain(changed_boxes(), 2), ChangeOptions()));
  ASSERT_EQ(comparison.registration.verdict, RegistrationVerdict::kSamePlace)
      << comparison.registration.message;
  EXPECT_FALSE(comparison.sees_a || comparison.sees_b);
  EXPECT_EQ(area_of(comparison, RegionKind::kRemoved) + area_of(comparison, RegionKind::kAdded), 0);
  EXPECT_GT(area_of(comparison, RegionKind::kMovedTowards), 0.02);
}

TEST(Compare, OptionsOutOfRangeAreNamed) {
  const auto message_of = [](const ChangeOptions& options) {
    return validate(options).ok() ? "" : validate(options).error().message;
  };
  EXPECT_EQ(message_of({}), "");
  EXPECT_THAT(message_of({0.2, 3, 0.003}), HasSubstr("the least change [m] is 0.2"));
  EXPECT_THAT(message_of({0.01, 0, 0.003}), HasSubstr("standard deviations is 0"));
  EXPECT_THAT(message_of({0.01, 3, std::nan("")}), HasSubstr("the least area"));
}

TEST(CompareOutput, TheReportSaysAllAndThePlyHasEveryPoint) {
  const auto report = nlohmann::json::parse(format_comparison_json(changed(), ChangeOptions()));
  EXPECT_EQ(report["verdict"], "same_place");
  EXPECT_EQ(report["a_from_b"].size(), 4u);
  EXPECT_EQ(report["covariance"].size(), 6u);
  EXPECT_EQ(report["regions"].size(), changed().regions.size());
  const std::string ply = format_changes_ply(changed());
  EXPECT_EQ(ply, format_changes_ply(changed()));
  const Result<output::PlyShape> shape = output::parse_ply(ply);
  ASSERT_TRUE(shape.ok()) << shape.error().message;
  EXPECT_GT(shape->positions.size(), changed().surfels_a.size()) << "and the added ones";
  EXPECT_TRUE(std::any_of(shape->colors.begin(), shape->colors.end(),
                          [](const Rgb8& c) { return c.r > c.b + 50 && c.r > c.g + 50; }));
}

}  // namespace hermite::compare::compare_test
