// Clouds of rooms made of rectangles, with a little noise. In room coordinates x and y are along
// the floor and z is up; the world is that of a first camera that is not quite level.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <utility>

#include "core/dataset/trajectory.h"
#include "core/output/cloud.h"

namespace hermite::test {

// A side of a rectangle in its own plane.
struct Stretch {
  double low, high;
};

// Whether there is surface at a place of a wall: along it, and above the floor.
using WallShape = std::function<bool(double along_m, double height_m)>;
inline bool is_whole(double, double) { return true; }

class RoomCloud {
 public:
  // Walls face +x, -x, +y or -y: at x or y = `at`, over a stretch of the other axis.
  void wall_x(double at, double facing, Stretch y, Stretch z, const WallShape& shape = is_whole) {
    fill(y, z, [&](double along, double height) {
      if (shape(along, height)) add({at, along, height}, {facing, 0, 0});
    });
  }
  void wall_y(double at, double facing, Stretch x, Stretch z, const WallShape& shape = is_whole) {
    fill(x, z, [&](double along, double height) {
      if (shape(along, height)) add({along, at, height}, {0, facing, 0});
    });
  }
  void level(double at, double facing, Stretch x, Stretch y) {
    fill(x, y, [&](double first, double second) { add({first, second, at}, {0, 0, facing}); });
  }
  void box(Stretch x, Stretch y, Stretch z) {
    wall_x(x.low, -1, y, z), wall_x(x.high, 1, y, z), wall_y(y.low, -1, x, z),
        wall_y(y.high, 1, x, z), level(z.high, 1, x, y);
  }
  // Four walls, the floor and the ceiling.
  void room(Stretch x, Stretch y, double height) {
    wall_x(x.low, 1, y, {0, height}), wall_x(x.high, -1, y, {0, height});
    wall_y(y.low, 1, x, {0, height}), wall_y(y.high, -1, x, {0, height});
    level(0, 1, x, y), level(height, -1, x, y);
  }
  void add(const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal) {
    output::CloudPoint point;
    point.position_m = (world_from_room_ * (at_m + noise() * normal) + origin_m_).cast<float>();
    point.normal = (world_from_room_ * normal).cast<float>();
    point.confidence = 20;
    point.radius_m = 0.01f;
    cloud_.push_back(point);
  }
  // A pose that looks along a direction of the room, upright.
  void look(const Eigen::Vector3d& at_m, const Eigen::Vector3d& along) {
    Eigen::Matrix3d room_from_camera;
    const Eigen::Vector3d forward = along.normalized(),
                          right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    room_from_camera << right, forward.cross(right), forward;
    path_.push_back({0.1 * static_cast<double>(path_.size()),
                     {Eigen::Quaterniond(world_from_room_ * room_from_camera),
                      world_from_room_ * at_m + origin_m_}});
  }

  const output::Cloud& cloud() const { return cloud_; }
  const dataset::Trajectory& path() const { return path_; }
  Eigen::Vector3d up() const { return world_from_room_ * Eigen::Vector3d::UnitZ(); }
  Eigen::Vector3d to_room(const Eigen::Vector3d& world_m) const {
    return world_from_room_.transpose() * (world_m - origin_m_);
  }

 private:
  template <class Place>
  void fill(Stretch first, Stretch second, const Place& place) {
    constexpr double kStep_m = 0.0125;
    for (double a = first.low + kStep_m / 2; a < first.high; a += kStep_m)
      for (double b = second.low + kStep_m / 2; b < second.high; b += kStep_m) place(a, b);
  }
  // Up to 3 mm, by a fixed sequence.
  double noise() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return 0.006 * (static_cast<double>(state_ >> 40) / static_cast<double>(1 << 24) - 0.5);
  }

  output::Cloud cloud_;
  dataset::Trajectory path_;
  std::uint64_t state_ = 1;
  const Eigen::Matrix3d world_from_room_ =
      (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(std::acos(-1.0) / 2, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Vector3d origin_m_{0.3, 1.4, 2.0};
};

}  // namespace hermite::test
