#include "core/synthetic/room_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kCell_m = 0.08f;
// Grid points of a block share the list of bodies that can be nearest to any of them.
constexpr int kBlock_cells = 4;

int cells_over(double length_m) { return static_cast<int>(std::ceil(length_m / kCell_m)) + 1; }

// A point of a wall belongs to the zone in front of it.
constexpr float kIntoZone_m = 0.02f;

constexpr int kTableSize = 4096;

std::array<std::uint8_t, kTableSize> make_srgb_table() {
  std::array<std::uint8_t, kTableSize> table{};
  for (int i = 0; i < kTableSize; ++i) {
    const double linear = i / (kTableSize - 1.0);
    const double srgb =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255 * srgb));
  }
  return table;
}

Vector3f nearest_on(const Vector3f& from, const Vector3f& to, const Vector3f& point) {
  const Vector3f along = to - from;
  const float length2 = along.squaredNorm();
  if (length2 == 0) return from;
  return from + std::clamp((point - from).dot(along) / length2, 0.0f, 1.0f) * along;
}

// Returns the weight of a zone at a place: 0 outside it; where zones overlap, the light changes
// smoothly from one to the other.
float share_of(const LightZone& zone, const Vector2f& place) {
  const Vector2f from_low = place - zone.low_m, from_high = zone.high_m - place;
  return from_low.minCoeff() > 0 && from_high.minCoeff() > 0 ? from_low.prod() * from_high.prod()
                                                             : 0.0f;
}

float outside2(const LightZone& zone, const Vector2f& place) {
  return (zone.low_m - place).cwiseMax(place - zone.high_m).cwiseMax(0.0f).squaredNorm();
}

// Returns the light of a zone at a point whose surroundings are open.
Vector3f light_of(const LightZone& zone, const Vector3f& point, const Vector3f& normal) {
  const Vector3f lamp_color(1.0f, 0.93f, 0.82f), window_color(0.86f, 0.94f, 1.0f);
  const auto from = [&](const Vector3f& source, float half_distance2) {
    const Vector3f way = source - point;
    const float distance2 = way.squaredNorm();
    // Half Lambert: large lights reach around edges, and no face becomes uniformly black.
    const float cosine = 0.5f + 0.5f * normal.dot(way) / std::sqrt(distance2 + 1e-6f);
    return cosine * cosine / (1.0f + distance2 / half_distance2);
  };
  return 0.30f * Vector3f::Ones() +
         0.85f * from(nearest_on(zone.lamp_from_m, zone.lamp_to_m, point), 6.0f) * lamp_color +
         0.55f * from(zone.window_m, 5.0f) * window_color;
}

// Returns the bodies that can be nearest to a point within `reach_m` of `middle`: a distance
// changes by at most the distance moved.
Furniture nearest_candidates(const Furniture& furniture, const Vector3d& middle, double reach_m) {
  std::vector<double> distances_m;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Shape& shape : furniture.shapes) {
    const double distance_m =
        signed_distance(shape, shape.world_from_shape.transpose() * (middle - shape.center));
    distances_m.push_back(distance_m);
    nearest_m = std::min(nearest_m, distance_m);
  }
  constexpr double kRounding_m = 1e-6;
  Furniture candidates;
  for (std::size_t i = 0; i < distances_m.size(); ++i)
    if (distances_m[i] <= nearest_m + 2 * reach_m + kRounding_m)
      candidates.shapes.push_back(furniture.shapes[i]);
  return candidates;
}

}  // namespace

double signed_distance(const Furniture& furniture, const Vector3d& point_in_world) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Shape& shape : furniture.shapes) {
    const Vector3d offset = point_in_world - shape.center;
    // The bounding sphere is never farther than the body, which suffices for most bodies. The room
    // surrounds everything.
    if (shape.kind != ShapeKind::kRoom &&
        offset.norm() - bounding_half_sides(shape).norm() >= nearest)
      continue;
    nearest =
        std::min(nearest, signed_distance(shape, shape.world_from_shape.transpose() * offset));
  }
  return nearest;
}

RoomLight::RoomLight(const Furniture& furniture) : zones_(furniture.lights) {
  CHECK(!furniture.shapes.empty() && !zones_.empty(), "a scene has a shell and a light");
  const Shape& shell = furniture.shapes.front();
  low_m_ = (shell.center - shell.size).cast<float>();
  size_x_ = cells_over(2 * shell.size.x());
  size_y_ = cells_over(2 * shell.size.y());
  size_z_ = cells_over(2 * shell.size.z());
  clearance_grid_m_.resize(static_cast<std::size_t>(size_x_) * static_cast<std::size_t>(size_y_) *
                           static_cast<std::size_t>(size_z_));
  for (int z = 0; z < size_z_; z += kBlock_cells)
    for (int y = 0; y < size_y_; y += kBlock_cells)
      for (int x = 0; x < size_x_; x += kBlock_cells) fill_block(furniture, x, y, z);
}

Vector3f RoomLight::grid_point(int x, int y, int z) const {
  return Vector3f(low_m_.x() + kCell_m * static_cast<float>(x),
                  low_m_.y() + kCell_m * static_cast<float>(y),
                  low_m_.z() + kCell_m * static_cast<float>(z));
}

void RoomLight::fill_block(const Furniture& furniture, int x0, int y0, int z0) {
  const int x1 = std::min(x0 + kBlock_cells, size_x_), y1 = std::min(y0 + kBlock_cells, size_y_),
            z1 = std::min(z0 + kBlock_cells, size_z_);
  const Vector3d low = grid_point(x0, y0, z0).cast<double>(),
                 high = grid_point(x1 - 1, y1 - 1, z1 - 1).cast<double>();
  const Furniture near = nearest_candidates(furniture, (low + high) / 2, (high - low).norm() / 2);
  for (int z = z0; z < z1; ++z)
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const std::size_t index = (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_y_) +
                                   static_cast<std::size_t>(y)) *
                                      static_cast<std::size_t>(size_x_) +
                                  static_cast<std::size_t>(x);
        clearance_grid_m_[index] = static_cast<float>(
            std::max(0.0, signed_distance(near, grid_point(x, y, z).cast<double>())));
      }
}

float RoomLight::clearance_m(const Vector3f& point) const {
  const auto split = [](float position, int size) {
    const float clamped = std::clamp(position / kCell_m, 0.0f, static_cast<float>(size) - 1.001f);
    const int cell = static_cast<int>(clamped);
    return std::pair(cell, clamped - static_cast<float>(cell));
  };
  const auto [x, tx] = split(point.x() - low_m_.x(), size_x_);
  const auto [y, ty] = split(point.y() - low_m_.y(), size_y_);
  const auto [z, tz] = split(point.z() - low_m_.z(), size_z_);
  const float* corner =
      clearance_grid_m_.data() + (static_cast<std::ptrdiff_t>(z) * size_y_ + y) * size_x_ + x;
  const auto along_x = [&, t = tx](const float* row) { return row[0] + t * (row[1] - row[0]); };
  const auto plane = [&, t = ty](const float* row) {
    const float low = along_x(row), high = along_x(row + size_x_);
    return low + t * (high - low);
  };
  const float low = plane(corner),
              high = plane(corner + static_cast<std::ptrdiff_t>(size_x_) * size_y_);
  return low + tz * (high - low);
}

Vector3f RoomLight::zones_light(const Vector3f& point, const Vector3f& normal) const {
  if (zones_.size() == 1) return light_of(zones_.front(), point, normal);
  const Vector2f place = (point + kIntoZone_m * normal).head<2>();
  Vector3f sum = Vector3f::Zero();
  float shares = 0;
  for (const LightZone& zone : zones_) {
    const float share = share_of(zone, place);
    if (share == 0) continue;
    sum += share * light_of(zone, point, normal);
    shares += share;
  }
  if (shares > 0) return sum / shares;
  const auto nearer = [&](const LightZone& a, const LightZone& b) {
    return outside2(a, place) < outside2(b, place);
  };
  return light_of(*std::min_element(zones_.begin(), zones_.end(), nearer), point, normal);
}

Vector3f RoomLight::at(const Vector3d& point_in_world, const Vector3d& normal_in_world) const {
  const Vector3f point = point_in_world.cast<float>(), normal = normal_in_world.cast<float>();
  // Free space in front of the surface, which is small in corners and under furniture (Evans 2006).
  const float near = std::min(1.0f, clearance_m(point + 0.10f * normal) / 0.10f),
              far = std::min(1.0f, clearance_m(point + 0.35f * normal) / 0.35f);
  const float open = 0.35f + 0.25f * near + 0.40f * far;
  return open * zones_light(point, normal);
}

Rgb8 srgb_from_linear(const Vector3f& linear) {
  static const std::array<std::uint8_t, kTableSize> kTable = make_srgb_table();
  const auto byte = [](float value) {
    return kTable[static_cast<std::size_t>(std::clamp(value, 0.0f, 1.0f) * (kTableSize - 1) +
                                           0.5f)];
  };
  return {byte(linear.x()), byte(linear.y()), byte(linear.z())};
}

}  // namespace hermite::synthetic
