#include "core/measure/plane_measures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/measured_places.h"

namespace hermite::measure {
namespace plane_measures_test {

using Eigen::Vector3d;

// Seen from every side: a camera in the middle that has looked around.
MapKnowledge looked_around() {
  dataset::Trajectory trajectory;
  for (int i = 0; i < 12; ++i)
    trajectory.push_back({static_cast<double>(i), Rigid3{Eigen::Quaterniond(Eigen::AngleAxisd(
                                                             i * M_PI / 6, Vector3d::UnitY())),
                                                         {0, 0, 0}}});
  return {CameraWay(trajectory), 1, false};
}

MeasuredPlane plane_at(const Vector3d& position_m, const Vector3d& normal,
                       double slope_sigma = 0.002) {
  MeasuredPlane plane;
  plane.place = test::place_at(position_m, normal, 0.0005);
  plane.centre_m = position_m;
  plane.axes = {normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal())};
  plane.slope_sigma = {slope_sigma, slope_sigma};
  plane.height_sigma_m = 0.0005;
  return plane;
}

TEST(DistanceToPlane, ItIsStraightAcrossAndWorseWhereThePlaneIsFar) {
  const MapKnowledge map = looked_around();
  const MeasuredPlane wall = plane_at({0, 0, 2}, {0, 0, -1});
  const Quantity near =
      or_throw(distance_to_plane(test::place_at({0.1, 0, 1.5}, {0, 0, -1}), wall, map));
  EXPECT_EQ(near.kind, MeasureKind::kPlane);
  EXPECT_NEAR(near.value, 0.5, 1e-12);
  EXPECT_NEAR(near.surface_sigma, std::hypot(0.001, std::hypot(0.0005, 0.002 * 0.1)), 1e-9);
  const Quantity far =
      or_throw(distance_to_plane(test::place_at({1.0, 0, 1.5}, {0, 0, -1}), wall, map));
  EXPECT_NEAR(far.value, 0.5, 1e-12);
  EXPECT_GT(far.half_width, near.half_width);
  const Quantity behind =
      or_throw(distance_to_plane(test::place_at({0, 0, 2.25}, {0, 0, -1}), wall, map));
  EXPECT_NEAR(behind.value, 0.25, 1e-12);
}

TEST(Angle, ItIsWhatTheSurfacesEnclose) {
  const MapKnowledge map = looked_around();
  const MeasuredPlane front = plane_at({0, 0, 2}, {0, 0, -1});
  const auto degrees = [&](const MeasuredPlane& other) {
    return or_throw(angle_between(front, other, map)).value;
  };
  EXPECT_NEAR(degrees(plane_at({2, 0, 0.1}, {-1, 0, 0})), 90, 1e-9) << "the corner of a room";
  EXPECT_NEAR(degrees(plane_at({1, 0, 2}, {0, 0, -1})), 180, 1e-9) << "one wall";
  EXPECT_NEAR(degrees(plane_at({0, 0, -2}, {0, 0, 1})), 0, 1e-9) << "walls that face each other";
  EXPECT_NEAR(degrees(plane_at({1.5, 0, 1.5}, Vector3d(-1, 0, -1).normalized())), 135, 1e-9)
      << "a bay";
}

TEST(Angle, SlopesAlongTheTurnCount) {
  const MapKnowledge map = looked_around();
  MeasuredPlane front = plane_at({0, 0, 2}, {0, 0, -1}, 0),
                side = plane_at({2, 0, 0.1}, {-1, 0, 0}, 0);
  const double exact = or_throw(angle_between(front, side, map)).half_width;
  front.axes = {Vector3d::UnitX(), Vector3d::UnitY()};
  front.slope_sigma = {0, 0.01};
  EXPECT_NEAR(or_throw(angle_between(front, side, map)).half_width, exact, 1e-9)
      << "the wall leans: the corner is as it was";
  front.slope_sigma = {0.01, 0};
  const Quantity angle = or_throw(angle_between(front, side, map));
  EXPECT_NEAR(angle.surface_sigma, 0.01 * 180 / M_PI, 1e-9);
  EXPECT_GT(angle.half_width, exact + 0.5);
}

TEST(Angle, OfOneWallTheErrorIsThatOfTwoDimensions) {
  const MapKnowledge map = looked_around();
  const Quantity flat = or_throw(
      angle_between(plane_at({0, 0, 2}, {0, 0, -1}), plane_at({1, 0, 2}, {0, 0, -1}), map));
  EXPECT_NEAR(flat.half_width,
              kDeviationsOfConfidenceIn2d * std::hypot(flat.surface_sigma, flat.pose_sigma), 1e-12);
}

}  // namespace plane_measures_test
}  // namespace hermite::measure
