#include "core/synthetic/room_builder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

Eigen::Matrix3d quarter_turns(int count) {
  constexpr int kCosine[] = {1, 0, -1, 0};
  const int cosine = kCosine[count & 3], sine = kCosine[(count + 3) & 3];
  Eigen::Matrix3d rotation;
  rotation << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  return rotation;
}

}  // namespace

int Furnisher::material(Pattern pattern, std::uint32_t first, std::uint32_t second, float glow) {
  const auto count = static_cast<std::uint32_t>(out.materials.size());
  out.materials.push_back(
      {pattern, linear_from_srgb(first), linear_from_srgb(second), glow, 17u + 131u * count});
  return static_cast<int>(count);
}

Shape& Furnisher::box(Span x, Span y, Span z, int material) {
  return add(ShapeKind::kBox, {(x.high - x.low) / 2, (y.high - y.low) / 2, (z.high - z.low) / 2},
             {(x.low + x.high) / 2, (y.low + y.high) / 2, (z.low + z.high) / 2}, material);
}

Shape& Furnisher::sphere(const Vector3d& center, double radius, int material) {
  return add(ShapeKind::kSphere, {radius, 0, 0}, center, material);
}

Shape& Furnisher::column(double x, double y, Span z, double radius, int material) {
  return add(ShapeKind::kCylinder, {radius, (z.high - z.low) / 2, 0}, {x, y, (z.low + z.high) / 2},
             material);
}

Shape& Furnisher::rod(const Vector3d& from, const Vector3d& to, double radius, int material) {
  Shape& shape =
      add(ShapeKind::kCylinder, {radius, (to - from).norm() / 2, 0}, (from + to) / 2, material);
  shape.world_from_shape =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from).toRotationMatrix();
  return shape;
}

Shape& Furnisher::torus(const Vector3d& center, double ring_radius, double tube_radius,
                        int material) {
  return add(ShapeKind::kTorus, {ring_radius, tube_radius, 0}, center, material);
}

Shape& Furnisher::add(ShapeKind kind, const Vector3d& size, const Vector3d& center, int material) {
  out.shapes.push_back({kind, size, Eigen::Matrix3d::Identity(), center, material});
  return out.shapes.back();
}

void Furnisher::name(const std::string& name, std::size_t first) {
  std::string unique = name;
  const auto is_taken = [&] {
    return std::any_of(out.objects.begin(), out.objects.end(),
                       [&](const NamedObject& object) { return object.name == unique; });
  };
  for (int number = 2; is_taken(); ++number) unique = name + std::to_string(number);
  out.objects.push_back({unique, first, out.shapes.size()});
}

void turn(Shape& shape, double angle_deg, const Vector3d& axis) {
  shape.world_from_shape =
      Eigen::AngleAxisd(angle_deg * M_PI / 180, axis).toRotationMatrix() * shape.world_from_shape;
}

void turn_group(Furniture& furniture, std::size_t first, double angle_deg, double x, double y) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(angle_deg * M_PI / 180, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d pivot(x, y, 0);
  for (std::size_t i = first; i < furniture.shapes.size(); ++i) {
    Shape& shape = furniture.shapes[i];
    shape.center = pivot + rotation * (shape.center - pivot);
    shape.world_from_shape = rotation * shape.world_from_shape;
  }
}

void move_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place) {
  const Eigen::Matrix3d rotation = quarter_turns(place.quarter_turns);
  const Vector3d from(place.from.x(), place.from.y(), 0), to(place.to.x(), place.to.y(), 0);
  for (std::size_t i = first; i < last; ++i) {
    Shape& shape = furniture.shapes[i];
    shape.center = to + rotation * (shape.center - from);
    shape.world_from_shape = rotation * shape.world_from_shape;
  }
}

void copy_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place) {
  const std::size_t copy = furniture.shapes.size();
  furniture.shapes.reserve(copy + last - first);
  for (std::size_t i = first; i < last; ++i) furniture.shapes.push_back(furniture.shapes[i]);
  move_group(furniture, copy, furniture.shapes.size(), place);
}

}  // namespace hermite::synthetic
