#include "core/dataset/room_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hermite {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kCell_m = 0.08f;
constexpr float kLow_x_m = -static_cast<float>(kRoomLength_m) / 2, kLow_y_m = -static_cast<float>(kRoomWidth_m) / 2, kLow_z_m = 0;

int cells_over(double length_m) { return static_cast<int>(std::ceil(length_m / kCell_m)) + 1; }

constexpr int kTableSize = 4096;

std::array<std::uint8_t, kTableSize> make_srgb_table() {
  std::array<std::uint8_t, kTableSize> table{};
  for (int i = 0; i < kTableSize; ++i) {
    const double linear = i / (kTableSize - 1.0);
    const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255 * srgb));
  }
  return table;
}

}  // namespace

double signed_distance(const Furniture& furniture, const Vector3d& point_in_world) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Shape& shape : furniture.shapes) {
    const Vector3d offset = point_in_world - shape.center;
    // The bounding sphere is never further than the body: most bodies need no more than this. The room surrounds everything.
    if (shape.kind != ShapeKind::kRoom && offset.norm() - bounding_half_sides(shape).norm() >= nearest) continue;
    nearest = std::min(nearest, signed_distance(shape, shape.world_from_shape.transpose() * offset));
  }
  return nearest;
}

RoomLight::RoomLight(const Furniture& furniture)
    : size_x_(cells_over(kRoomLength_m)), size_y_(cells_over(kRoomWidth_m)), size_z_(cells_over(kRoomHeight_m)) {
  clearance_grid_m_.reserve(static_cast<std::size_t>(size_x_) * static_cast<std::size_t>(size_y_) * static_cast<std::size_t>(size_z_));
  for (int z = 0; z < size_z_; ++z)
    for (int y = 0; y < size_y_; ++y)
      for (int x = 0; x < size_x_; ++x) {
        const Vector3f point(kLow_x_m + kCell_m * static_cast<float>(x), kLow_y_m + kCell_m * static_cast<float>(y),
                             kLow_z_m + kCell_m * static_cast<float>(z));
        clearance_grid_m_.push_back(static_cast<float>(std::max(0.0, signed_distance(furniture, point.cast<double>()))));
      }
}

float RoomLight::clearance_m(const Vector3f& point) const {
  const auto split = [](float position, int size) {
    const float clamped = std::clamp(position / kCell_m, 0.0f, static_cast<float>(size) - 1.001f);
    const int cell = static_cast<int>(clamped);
    return std::pair(cell, clamped - static_cast<float>(cell));
  };
  const auto [x, tx] = split(point.x() - kLow_x_m, size_x_);
  const auto [y, ty] = split(point.y() - kLow_y_m, size_y_);
  const auto [z, tz] = split(point.z() - kLow_z_m, size_z_);
  const float* corner = clearance_grid_m_.data() + (static_cast<std::ptrdiff_t>(z) * size_y_ + y) * size_x_ + x;
  const auto along_x = [&, t = tx](const float* row) { return row[0] + t * (row[1] - row[0]); };
  const auto plane = [&, t = ty](const float* row) {
    const float low = along_x(row), high = along_x(row + size_x_);
    return low + t * (high - low);
  };
  const float low = plane(corner), high = plane(corner + static_cast<std::ptrdiff_t>(size_x_) * size_y_);
  return low + tz * (high - low);
}

Vector3f RoomLight::at(const Vector3d& point_in_world, const Vector3d& normal_in_world) const {
  const Vector3f point = point_in_world.cast<float>(), normal = normal_in_world.cast<float>();
  const Vector3f lamp_position(0.15f, -0.1f, 2.3f), window_position(2.4f, -0.1f, 1.7f);
  const Vector3f lamp_color(1.0f, 0.93f, 0.82f), window_color(0.86f, 0.94f, 1.0f);

  const auto from = [&](const Vector3f& source, float half_distance2) {
    const Vector3f way = source - point;
    const float distance2 = way.squaredNorm();
    // Half Lambert: large lights reach around edges, and no face turns flat black.
    const float cosine = 0.5f + 0.5f * normal.dot(way) / std::sqrt(distance2 + 1e-6f);
    return cosine * cosine / (1.0f + distance2 / half_distance2);
  };
  // Free space in front of the surface: little of it in corners and under furniture (Evans 2006).
  const float near = std::min(1.0f, clearance_m(point + 0.10f * normal) / 0.10f),
              far = std::min(1.0f, clearance_m(point + 0.35f * normal) / 0.35f);
  const float open = 0.35f + 0.25f * near + 0.40f * far;
  return open *
         (0.30f * Vector3f::Ones() + 0.85f * from(lamp_position, 6.0f) * lamp_color + 0.55f * from(window_position, 5.0f) * window_color);
}

Rgb8 srgb_from_linear(const Vector3f& linear) {
  static const std::array<std::uint8_t, kTableSize> kTable = make_srgb_table();
  const auto byte = [](float value) { return kTable[static_cast<std::size_t>(std::clamp(value, 0.0f, 1.0f) * (kTableSize - 1) + 0.5f)]; };
  return {byte(linear.x()), byte(linear.y()), byte(linear.z())};
}

}  // namespace hermite
