#include "core/compare/register.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/compare/made_corner.h"

namespace hermite::compare::register_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

Registration registered(const ComparedScan& a, const ComparedScan& b) {
  const double spacing_m = coarse_spacing_m(a, b);
  return register_scans(CoarseScan(a, spacing_m), CoarseScan(b, spacing_m));
}

ComparedScan scan_of(output::Cloud cloud, dataset::Trajectory path = {}) {
  return or_throw(ComparedScan::create(std::move(cloud), std::move(path), "scan"));
}

// Six walls of one colour around the camera.
ComparedScan closed_box(unsigned seed) {
  const Vector3d x(1.2, 0, 0), y(0, 0.8, 0), z(0, 0, 0.6);
  test::CornerMaker maker(seed, 0.02);
  const Rgb8 grey{128, 128, 128};
  maker.add({0, 0, 0}, x, y, grey);
  maker.add(z, y, x, grey);
  maker.add({0, 0, 0}, y, z, grey);
  maker.add(x, z, y, grey);
  maker.add({0, 0, 0}, z, x, grey);
  maker.add(y, x, z, grey);
  dataset::Trajectory path;
  for (int i = 0; i < 8; ++i)
    path.push_back(
        {0.1 * i, test::looking_at({0.6, 0.4, 0.3}, Vector3d(0.6 + std::cos(0.8 * i),
                                                             0.4 + std::sin(0.8 * i), 0.3))});
  return scan_of(std::move(maker.cloud), path);
}

TEST(Register, ASymmetricPlaceIsSaidToBeAmbiguous) {
  const Registration found = registered(closed_box(1), closed_box(2));
  EXPECT_EQ(found.verdict, RegistrationVerdict::kAmbiguous) << found.message;
  EXPECT_THAT(found.message, HasSubstr("180 degrees"));
}

TEST(Register, OtherPlacesAreSaidToBeOthers) {
  test::CornerMaker ball(1, 0.02);
  for (int i = 0; i < 60; ++i)
    for (int j = 1; j < 30; ++j) {
      output::CloudPoint point;
      const double longitude = 2 * M_PI * i / 60, latitude = M_PI * (j / 30.0 - 0.5);
      point.normal = Vector3d(std::cos(latitude) * std::cos(longitude),
                              std::cos(latitude) * std::sin(longitude), std::sin(latitude))
                         .cast<float>();
      point.position_m = 0.3f * point.normal;
      point.confidence = 5;
      ball.cloud.push_back(point);
    }
  const Registration found =
      registered(test::corner_scan(test::usual_boxes()), scan_of(std::move(ball.cloud)));
  EXPECT_EQ(found.verdict, RegistrationVerdict::kDifferentPlaces) << found.message;
  EXPECT_THAT(found.message, HasSubstr("do not show the same place"));
}

TEST(Register, PointsTooFarApartAreNotCalledAnotherPlace) {
  const auto sparse = [](unsigned seed) {
    return scan_of(test::corner_cloud(test::usual_boxes(), seed, 0.04));
  };
  const Registration found = registered(sparse(1), sparse(2));
  EXPECT_EQ(found.verdict, RegistrationVerdict::kTooSparse);
  EXPECT_THAT(found.message, HasSubstr("cannot be aligned"));
  EXPECT_THAT(found.message, HasSubstr("points too far apart"));
}

TEST(Register, AMirroredScanIsToldFromAnotherPlace) {
  output::Cloud cloud = test::corner_cloud(test::usual_boxes(), 2);
  for (output::CloudPoint& point : cloud) {
    point.position_m.y() = -point.position_m.y();
    point.normal.y() = -point.normal.y();
  }
  const Registration found =
      registered(test::corner_scan(test::usual_boxes()), scan_of(std::move(cloud)));
  EXPECT_EQ(found.verdict, RegistrationVerdict::kMirrored) << found.message;
}

TEST(Register, SurfacesThatDoNotHoldTheScansAreSaidTo) {
  const auto floor = [](unsigned seed) {
    test::CornerMaker maker(seed, 0.015);
    maker.add({0, 0, 0}, {1.2, 0, 0}, {0, 0.4, 0}, {150, 120, 90});
    maker.add({1.2, 0, 0}, {-1.2, 0, 0}, {0, 0, 0.4}, {220, 220, 215});
    return scan_of(std::move(maker.cloud));
  };
  const Registration found = registered(floor(1), floor(2));
  EXPECT_TRUE(found.verdict == RegistrationVerdict::kSliding ||
              found.verdict == RegistrationVerdict::kAmbiguous)
      << name_of(found.verdict) << ": " << found.message;
}

}  // namespace hermite::compare::register_test
