// A corner of a small room with boxes in it, as the surfels and the path of a scan. Header only.
#pragma once

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "core/compare/compared_scan.h"

namespace hermite::test {

struct MadeBox {
  Eigen::Vector3d low_m, high_m;
  Rgb8 color;
};

inline std::vector<MadeBox> usual_boxes() {
  return {{{0.15, 0.10, 0}, {0.40, 0.30, 0.22}, {200, 60, 50}},
          {{0.70, 0.12, 0}, {0.86, 0.40, 0.35}, {60, 160, 70}},
          {{0.30, 0.55, 0}, {0.48, 0.70, 0.12}, {60, 80, 190}},
          {{0.85, 0.60, 0}, {1.00, 0.72, 0.18}, {190, 180, 60}}};
}

class CornerMaker {
 public:
  CornerMaker(unsigned seed, double spacing_m) : random_(seed), spacing_m_(spacing_m) {}

  // A rectangle from a corner along two directions; points within boxes are left out.
  void add(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
           const Rgb8& color) {
    const Eigen::Vector3d normal = u.cross(v).normalized();
    const int columns = static_cast<int>(u.norm() / spacing_m_),
              rows = static_cast<int>(v.norm() / spacing_m_);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const Eigen::Vector3d at = corner + (column + 0.5) / columns * u + (row + 0.5) / rows * v;
        if (is_inside(at)) continue;
        output::CloudPoint point;
        point.position_m = (at + noise_m_(random_) * normal).cast<float>();
        point.normal = normal.cast<float>();
        point.color = color;
        point.confidence = 10;
        point.radius_m = static_cast<float>(spacing_m_);
        cloud.push_back(point);
      }
  }

  void add_box(const MadeBox& box) {
    const Eigen::Vector3d size = box.high_m - box.low_m, x = size.x() * Eigen::Vector3d::UnitX(),
                          y = size.y() * Eigen::Vector3d::UnitY(),
                          z = size.z() * Eigen::Vector3d::UnitZ();
    add(box.low_m + z, x, y, box.color);
    add(box.low_m, x, z, box.color);           // faces -y
    add(box.low_m + x, y, z, box.color);       // faces +x
    add(box.low_m + x + y, -x, z, box.color);  // faces +y
    add(box.low_m + y, -y, z, box.color);      // faces -x
  }

  std::vector<MadeBox> boxes;
  output::Cloud cloud;

 private:
  bool is_inside(const Eigen::Vector3d& at) const {
    for (const MadeBox& box : boxes)
      if ((at.array() > box.low_m.array() + 1e-6).all() &&
          (at.array() < box.high_m.array() - 1e-6).all())
        return true;
    return false;
  }

  std::mt19937 random_;
  std::normal_distribution<double> noise_m_{0, 0.0007};
  double spacing_m_;
};

// Floor and two walls of different lengths, and the boxes. The camera goes around in front and
// looks at the corner.
inline output::Cloud corner_cloud(const std::vector<MadeBox>& boxes, unsigned seed = 1,
                                  double spacing_m = 0.015) {
  const Eigen::Vector3d x(1.2, 0, 0), y(0, 0.9, 0), z(0, 0, 0.6);
  CornerMaker maker(seed, spacing_m);
  for (const MadeBox& box : boxes)
    maker.boxes.push_back({box.low_m - Eigen::Vector3d(0, 0, 0.01), box.high_m, box.color});
  maker.add({0, 0, 0}, x, y, {150, 120, 90});
  maker.add(x, -x, z, {220, 220, 215});
  maker.add({0, 0, 0}, y, z, {120, 150, 170});
  maker.boxes.clear();
  for (const MadeBox& box : boxes) maker.add_box(box);
  return std::move(maker.cloud);
}

inline Rigid3 looking_at(const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
  const Eigen::Vector3d z = (at - from).normalized(),
                        x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return {Eigen::Quaterniond(axes), from};
}

inline dataset::Trajectory corner_path() {
  dataset::Trajectory path;
  for (int i = 0; i < 8; ++i) {
    const double share = i / 7.0;
    path.push_back({0.1 * i, looking_at({1.9 - 1.4 * share, 0.6 + 1.3 * share, 0.9 + 0.3 * share},
                                        {0.45, 0.35, 0.15})});
  }
  return path;
}

inline compare::ComparedScan corner_scan(const std::vector<MadeBox>& boxes, unsigned seed = 1,
                                         const Rigid3& world_from_corner = {}) {
  return or_throw(compare::ComparedScan::create(
      compare::moved_cloud(corner_cloud(boxes, seed), world_from_corner),
      compare::moved_trajectory(corner_path(), world_from_corner), "scan"));
}

inline Rigid3 elsewhere() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.3, -0.5, 0.8).normalized())),
          {1.5, -0.7, 0.4}};
}

}  // namespace hermite::test
