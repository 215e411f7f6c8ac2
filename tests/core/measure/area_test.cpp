#include "core/measure/area.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/measured_places.h"

namespace hermite::measure {
namespace area_test {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

// On a wall before the camera, two metres away.
std::vector<MeasuredPlace> on_wall(const std::vector<Vector2d>& corners,
                                   const Vector3d& normal = {0, 0, -1}) {
  std::vector<MeasuredPlace> places;
  for (const Vector2d& corner : corners)
    places.push_back(test::place_at({corner.x(), corner.y(), 2}, normal));
  return places;
}

std::string message_of_fault(const std::vector<MeasuredPlace>& corners) {
  const Result<Quantity> area = area_of(corners, test::seen_from({0}));
  return area.ok() ? std::string() : area.error().message;
}

TEST(Area, OfAnOutlineEitherWayAroundAndWithAnInwardCorner) {
  const MapKnowledge map = test::seen_from({0});
  const Quantity square =
      or_throw(area_of(on_wall({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}), map));
  EXPECT_EQ(square.kind, MeasureKind::kArea);
  EXPECT_NEAR(square.value, 1, 1e-12);
  EXPECT_NEAR(
      or_throw(area_of(on_wall({{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}), map)).value,
      1, 1e-12);
  EXPECT_NEAR(
      or_throw(
          area_of(on_wall({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0}, {0, 0}, {0, 0.5}, {-0.5, 0.5}}),
                  map))
          .value,
      0.75, 1e-12);
}

TEST(Area, ItsErrorIsThatOfTheCornersInThePlane) {
  const MapKnowledge map = test::seen_from({0});
  const std::vector<Vector2d> corners{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  const Quantity flat = or_throw(area_of(on_wall(corners), map));
  EXPECT_NEAR(flat.surface_sigma, 0, 1e-12) << "errors across the wall leave the area as it is";
  // A share of 0.04 % of both sides; and each corner, which moves against the others by 0.15 mm
  // along half a diagonal.
  EXPECT_GT(flat.pose_sigma, 0.0008);
  EXPECT_LT(flat.pose_sigma, 0.0009);
  const Quantity tilted = or_throw(area_of(on_wall(corners, Vector3d(1, 0, -1).normalized()), map));
  EXPECT_NEAR(tilted.surface_sigma, 0.001 * std::sqrt(0.5) * 0.5 * 2, 1e-9)
      << "a shift of one along x changes it by half a side";
  EXPECT_GT(tilted.half_width, flat.half_width);
}

TEST(Area, ATwistedOutlineIsBroughtToItsPlane) {
  std::vector<MeasuredPlace> corners =
      on_wall({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}});
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i].position_m.z() += i % 2 == 0 ? 0.01 : -0.01;
  EXPECT_NEAR(or_throw(area_of(corners, test::seen_from({0}))).value, 1, 1e-9);
}

TEST(Area, OutlinesThatHaveNoneAreRefusedWithAMessage) {
  EXPECT_THAT(message_of_fault(on_wall({{0, 0}, {1, 0}})), HasSubstr("3 to 64 corners, not 2"));
  EXPECT_THAT(message_of_fault(on_wall({{-0.5, -0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, 0.5}})),
              HasSubstr("crosses itself: its side from corner 1 to 2 meets that from 3 to 4"));
  EXPECT_THAT(message_of_fault(on_wall({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.25, 0}, {0, 0.5}})),
              HasSubstr("crosses itself"))
      << "it touches";
  EXPECT_THAT(message_of_fault(on_wall({{0, 0}, {0.5, 0}, {0.5, 0.001}, {0, 0.5}})),
              HasSubstr("corners 2 and 3 are the same place"));
  EXPECT_THAT(message_of_fault(on_wall({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0, 0.003}})),
              HasSubstr("corners 4 and 1 are the same place"));
  EXPECT_THAT(message_of_fault(on_wall({{0, 0}, {0.5, 0}, {0.25, 0.004}})),
              HasSubstr("on one line"));
  EXPECT_THAT(
      message_of_fault(std::vector<MeasuredPlace>(65, test::place_at({0, 0, 2}, {0, 0, -1}))),
      HasSubstr("not 65"));
}

}  // namespace area_test
}  // namespace hermite::measure
