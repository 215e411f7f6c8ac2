#include "core/synthetic/room_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

constexpr double kOnSurface_m = 1e-6;  // tori are traced to 1e-7 m

std::vector<Shape> solids() {
  std::vector<Shape> shapes(4);
  shapes[0] = {ShapeKind::kBox, {0.3, 0.5, 0.005}};
  shapes[1] = {ShapeKind::kSphere, {0.4, 0, 0}};
  shapes[2] = {ShapeKind::kCylinder, {0.01, 0.6, 0}};
  shapes[3] = {ShapeKind::kTorus, {0.4, 0.12, 0}};
  return shapes;
}

std::vector<Shape> all_kinds() {
  std::vector<Shape> shapes = solids();
  shapes.push_back({ShapeKind::kRoom, {2, 1.5, 1}});
  return shapes;
}

class RandomPoints {
 public:
  Vector3d within(double reach) {
    return {reach * uniform_(engine_), reach * uniform_(engine_), reach * uniform_(engine_)};
  }

 private:
  std::mt19937 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST(RoomShapes, KnownDistances) {
  const auto shapes = all_kinds();
  EXPECT_NEAR(signed_distance(shapes[0], {0.6, 0.9, 0}), 0.5, 1e-12) << "to the edge: 3-4-5";
  EXPECT_NEAR(signed_distance(shapes[0], {0, 0, 0.002}), -0.003, 1e-12);
  EXPECT_NEAR(signed_distance(shapes[1], {0, 0, 1}), 0.6, 1e-12);
  EXPECT_NEAR(signed_distance(shapes[2], {0.04, 0.04, 0.1}), 0.04 * std::sqrt(2) - 0.01, 1e-12);
  EXPECT_NEAR(signed_distance(shapes[2], {0.31, 0, 1.0}), 0.5, 1e-12) << "to the rim: 3-4-5";
  EXPECT_NEAR(signed_distance(shapes[3], {0, 0, 0}), 0.28, 1e-12) << "in the hole";
  EXPECT_NEAR(signed_distance(shapes[3], {0.4, 0, 0.05}), -0.07, 1e-12);
  EXPECT_NEAR(signed_distance(shapes[4], {1.5, 0, 0}), 0.5, 1e-12) << "free inside";
  EXPECT_NEAR(signed_distance(shapes[4], {2.25, 0, 0}), -0.25, 1e-12) << "in the wall";
}

TEST(RoomShapes, RaysEndOnTheSurfaceAndPassThroughFreeSpaceBefore) {
  RandomPoints points;
  for (const Shape& shape : all_kinds()) {
    int hit_count = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector3d origin = points.within(0.95);
      if (signed_distance(shape, origin) <= 1e-6) continue;
      const Vector3d direction = i % 2 ? Vector3d(points.within(0.2) - origin) : points.within(1.0);
      const double t = intersect(shape, origin, direction, 0);
      if (!std::isfinite(t)) continue;
      ++hit_count;
      EXPECT_NEAR(signed_distance(shape, origin + t * direction), 0, kOnSurface_m);
      for (int k = 1; k < 50; ++k)
        EXPECT_GT(signed_distance(shape, origin + t * (k / 50.0) * direction), -kOnSurface_m);
    }
    EXPECT_GT(hit_count, 20) << static_cast<int>(shape.kind);
  }
}

TEST(RoomShapes, RaysThatMissNeverTouch) {
  RandomPoints points;
  for (const Shape& shape : solids())
    for (int i = 0; i < 2000; ++i) {
      const Vector3d origin = points.within(0.95), direction = points.within(1.0).normalized();
      if (signed_distance(shape, origin) <= 1e-6 ||
          std::isfinite(intersect(shape, origin, direction, 0)))
        continue;
      for (int k = 0; k < 200; ++k)
        ASSERT_GT(signed_distance(shape, origin + 0.015 * k * direction), -kOnSurface_m);
    }
}

TEST(RoomShapes, AxisParallelRaysHaveNoSpecialCase) {
  const auto shapes = solids();
  EXPECT_NEAR(intersect(shapes[0], {0.1, 0.1, -1}, {0, 0, 1}, 0), 0.995, 1e-12);
  EXPECT_FALSE(std::isfinite(intersect(shapes[0], {0.4, 0.1, -1}, {0, 0, 1}, 0)));
  EXPECT_NEAR(intersect(shapes[2], {0.005, 0, -1}, {0, 0, 1}, 0), 0.4, 1e-12);
  EXPECT_NEAR(intersect(shapes[2], {-1, 0, 0.2}, {1, 0, 0}, 0), 0.99, 1e-12);
  EXPECT_FALSE(std::isfinite(intersect(shapes[2], {-1, 0, 0.7}, {1, 0, 0}, 0)));
  EXPECT_NEAR(intersect(shapes[3], {-1, 0, 0}, {1, 0, 0}, 0), 0.48, 1e-6);
  EXPECT_FALSE(std::isfinite(intersect(shapes[3], {0, 0, -1}, {0, 0, 1}, 0))) << "through the hole";
}

TEST(RoomShapes, TheNearestDistanceCounts) {
  const Shape sphere{ShapeKind::kSphere, {0.4, 0, 0}};
  EXPECT_FALSE(std::isfinite(intersect(sphere, {-1, 0, 0}, {1, 0, 0}, 0.7)))
      << "the entry lies before t_min";
  EXPECT_FALSE(std::isfinite(intersect(sphere, {-1, 0, 0}, {-1, 0, 0}, 0))) << "behind";
  EXPECT_NEAR(intersect(sphere, {-1, 0, 0}, {0.5, 0, 0}, 0), 1.2, 1e-12)
      << "in units of the direction's length";
}

TEST(RoomShapes, NormalsAreTheGradientOfTheDistance) {
  RandomPoints points;
  constexpr double kStep_m = 1e-6;
  for (const Shape& shape : all_kinds())
    for (int i = 0; i < 500; ++i) {
      const Vector3d origin = points.within(0.95), direction = points.within(0.3) - origin;
      if (signed_distance(shape, origin) <= 1e-6) continue;
      const double t = intersect(shape, origin, direction, 0);
      if (!std::isfinite(t)) continue;
      const Vector3d point = origin + t * direction;
      const SurfacePoint surface = describe(shape, point);
      EXPECT_NEAR(surface.normal.norm(), 1, 1e-9);
      EXPECT_LT(surface.normal.dot(direction), 1e-9) << "towards the free side";
      EXPECT_NEAR((signed_distance(shape, point + kStep_m * surface.normal) -
                   signed_distance(shape, point)) /
                      kStep_m,
                  1, 1e-3);
      EXPECT_EQ(surface.face, face_of(shape, point));
    }
}

TEST(RoomShapes, TheBoundingBoxHoldsTheSolid) {
  RandomPoints points;
  for (const Shape& shape : solids()) {
    const Vector3d half = bounding_half_sides(shape);
    for (int i = 0; i < 2000; ++i) {
      const Vector3d point = points.within(0.8);
      if (signed_distance(shape, point) <= 0) {
        EXPECT_LE((point.cwiseAbs() - half).maxCoeff(), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace hermite::synthetic
