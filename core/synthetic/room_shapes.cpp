#include "core/synthetic/room_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hermite::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMiss = std::numeric_limits<double>::infinity();
constexpr double kTorusTolerance_m = 1e-7;
// A ray that grazes the tube converges slowly; after this many steps it misses by less than the
// tolerance of a depth unit.
constexpr int kMaxTorusSteps = 256;

double box_distance(const Vector3d& half, const Vector3d& point) {
  const Vector3d outside = point.cwiseAbs() - half;
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

double cylinder_distance(double radius, double half_height, const Vector3d& point) {
  const Vector2d outside(point.head<2>().norm() - radius, std::abs(point.z()) - half_height);
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

double torus_distance(double ring_radius, double tube_radius, const Vector3d& point) {
  const double from_ring = std::sqrt(point.x() * point.x() + point.y() * point.y()) - ring_radius;
  return std::sqrt(from_ring * from_ring + point.z() * point.z()) - tube_radius;
}

struct Interval {
  double enter, leave;  // empty when enter > leave
};

Interval slabs(const Vector3d& half, const Vector3d& origin, const Vector3d& direction) {
  Interval inside{-kMiss, kMiss};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (std::abs(origin[axis]) > half[axis]) return {kMiss, -kMiss};
      continue;
    }
    const double inverse = 1.0 / direction[axis];
    const double center = -origin[axis] * inverse, reach = std::abs(half[axis] * inverse);
    inside.enter = std::max(inside.enter, center - reach);
    inside.leave = std::min(inside.leave, center + reach);
  }
  return inside;
}

// Returns where |origin + t direction|^2 <= radius^2, for vectors of two or three dimensions.
template <class Vector>
Interval ball(double radius, const Vector& origin, const Vector& direction) {
  const double a = direction.squaredNorm();
  const double closest = -origin.dot(direction) / a;
  // Uses the distance of the ray from the centre rather than b^2 - ac, which would cancel for a
  // thin rod far away.
  const double gap2 = (origin + closest * direction).squaredNorm();
  const double rest = radius * radius - gap2;
  if (!(rest >= 0)) return {kMiss, -kMiss};
  const double reach = std::sqrt(rest / a);
  return {closest - reach, closest + reach};
}

double first_of(const Interval& inside, double t_min) {
  return inside.enter <= inside.leave && inside.enter > t_min ? inside.enter : kMiss;
}

double intersect_cylinder(const Vector3d& size, const Vector3d& origin, const Vector3d& direction,
                          double t_min) {
  Interval inside{-kMiss, kMiss};
  if (direction.x() == 0 && direction.y() == 0) {
    if (origin.head<2>().norm() > size[0]) return kMiss;
  } else {
    inside = ball(size[0], Vector2d(origin.head<2>()), Vector2d(direction.head<2>()));
  }
  if (direction.z() == 0) return std::abs(origin.z()) <= size[1] ? first_of(inside, t_min) : kMiss;
  const double center = -origin.z() / direction.z(), reach = std::abs(size[1] / direction.z());
  return first_of({std::max(inside.enter, center - reach), std::min(inside.leave, center + reach)},
                  t_min);
}

// Sphere tracing: the distance is exact, so no step can pass through the surface.
double intersect_torus(const Vector3d& size, const Vector3d& origin, const Vector3d& direction,
                       double t_min) {
  const Interval near = ball(size[0] + size[1], origin, direction);
  const Interval flat = slabs({size[0] + size[1], size[0] + size[1], size[1]}, origin, direction);
  const double end = std::min(near.leave, flat.leave);
  const double length = direction.norm();
  double t = std::max({near.enter, flat.enter, t_min});
  for (int step = 0; step < kMaxTorusSteps && t <= end; ++step) {
    const double distance = torus_distance(size[0], size[1], origin + t * direction);
    if (distance < kTorusTolerance_m) return t > t_min ? t : kMiss;
    t += distance / length;
  }
  return kMiss;
}

int box_face(const Vector3d& half, const Vector3d& point) {
  int axis = 0;
  const Vector3d depth = half - point.cwiseAbs();
  depth.cwiseAbs().minCoeff(&axis);
  return 2 * axis + (point[axis] > 0 ? 1 : 0);
}

SurfacePoint describe_box(const Vector3d& half, const Vector3d& point, double outwards) {
  SurfacePoint surface;
  surface.face = box_face(half, point);
  const int axis = surface.face / 2;
  const double sign = surface.face % 2 == 1 ? 1 : -1;
  surface.normal = Vector3d::Zero();
  surface.normal[axis] = outwards * sign;
  // The second coordinate is z on upright faces, so that paintings and planks are upright.
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  surface.position_m = {point[first], point[second]};
  surface.half_size_m = {half[first], half[second]};
  return surface;
}

SurfacePoint describe_cylinder(const Vector3d& size, const Vector3d& point) {
  const double radius = size[0], half_height = size[1];
  const bool on_end =
      std::abs(std::abs(point.z()) - half_height) < std::abs(point.head<2>().norm() - radius);
  if (on_end) {
    const bool upper = point.z() > 0;
    return {{0, 0, upper ? 1.0 : -1.0}, point.head<2>(), {radius, radius}, upper ? 1 : 2};
  }
  const double angle = std::atan2(point.y(), point.x());
  return {Vector3d(point.x(), point.y(), 0).normalized(),
          {angle * radius, point.z()},
          {M_PI * radius, half_height},
          0};
}

SurfacePoint describe_torus(const Vector3d& size, const Vector3d& point) {
  const double angle = std::atan2(point.y(), point.x());
  const Vector3d on_ring(size[0] * std::cos(angle), size[0] * std::sin(angle), 0);
  const Vector3d normal = (point - on_ring).normalized();
  const double tube_angle = std::atan2(point.z(), point.head<2>().norm() - size[0]);
  return {normal, {angle * size[0], tube_angle * size[1]}, {M_PI * size[0], M_PI * size[1]}, 0};
}

}  // namespace

Vector3d bounding_half_sides(const Shape& shape) {
  const Vector3d& size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kRoom:
    case ShapeKind::kBox: return size;
    case ShapeKind::kSphere: return Vector3d::Constant(size[0]);
    case ShapeKind::kCylinder: return {size[0], size[0], size[1]};
    case ShapeKind::kTorus: return {size[0] + size[1], size[0] + size[1], size[1]};
  }
  return size;
}

double signed_distance(const Shape& shape, const Vector3d& point_in_shape) {
  const Vector3d& size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kRoom: return -box_distance(size, point_in_shape);
    case ShapeKind::kBox: return box_distance(size, point_in_shape);
    case ShapeKind::kSphere: return point_in_shape.norm() - size[0];
    case ShapeKind::kCylinder: return cylinder_distance(size[0], size[1], point_in_shape);
    case ShapeKind::kTorus: return torus_distance(size[0], size[1], point_in_shape);
  }
  return kMiss;
}

double intersect(const Shape& shape, const Vector3d& origin, const Vector3d& direction,
                 double t_min) {
  const Vector3d& size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kRoom: {
      const double leave = slabs(size, origin, direction).leave;
      return leave > t_min ? leave : kMiss;
    }
    case ShapeKind::kBox: return first_of(slabs(size, origin, direction), t_min);
    case ShapeKind::kSphere: return first_of(ball(size[0], origin, direction), t_min);
    case ShapeKind::kCylinder: return intersect_cylinder(size, origin, direction, t_min);
    case ShapeKind::kTorus: return intersect_torus(size, origin, direction, t_min);
  }
  return kMiss;
}

SurfacePoint describe(const Shape& shape, const Vector3d& point_in_shape) {
  const Vector3d& size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kRoom: return describe_box(size, point_in_shape, -1);
    case ShapeKind::kBox: return describe_box(size, point_in_shape, 1);
    case ShapeKind::kSphere: {
      const Vector3d normal = point_in_shape.normalized();
      const double longitude = std::atan2(normal.y(), normal.x()),
                   latitude = std::asin(std::clamp(normal.z(), -1.0, 1.0));
      return {normal,
              {longitude * size[0], latitude * size[0]},
              {M_PI * size[0], 0.5 * M_PI * size[0]},
              0};
    }
    case ShapeKind::kCylinder: return describe_cylinder(size, point_in_shape);
    case ShapeKind::kTorus: return describe_torus(size, point_in_shape);
  }
  return {};
}

int face_of(const Shape& shape, const Vector3d& point_in_shape) {
  switch (shape.kind) {
    case ShapeKind::kRoom:
    case ShapeKind::kBox: return box_face(shape.size, point_in_shape);
    case ShapeKind::kCylinder: return describe_cylinder(shape.size, point_in_shape).face;
    default: return 0;
  }
}

}  // namespace hermite::synthetic
