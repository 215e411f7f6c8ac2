#include "tests/reference/track_twin.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>

namespace hermite::test {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d project(const shared::Intrinsics& c, const Vector3d& p) { return {c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy}; }

// Derivative of value(exp(x) s) at x = 0.
Vector6d derivative(const Vector3d& s, const std::function<double(const Vector3d&)>& value) {
  constexpr double kStep = 1e-6;
  Vector6d result;
  for (int i = 0; i < 6; ++i) {
    const Vector6d twist = kStep * Vector6d::Unit(i);
    result[i] = (value(exp_se3(twist) * s) - value(exp_se3(-twist) * s)) / (2 * kStep);
  }
  return result;
}

void add_row(NormalEquations& sums, const Vector6d& row, double residual, double weight) {
  sums.hessian += weight * row * row.transpose();
  sums.right_hand_side -= weight * residual * row;
}

void add_geometry(TrackStep& sums, const SurfaceImage& reference, const Vector3d& s, const Vector3d& normal, const TrackOptions& options) {
  const Vector2d uv = project(reference.camera, s);
  const int x = static_cast<int>(std::floor(uv.x() + 0.5)), y = static_cast<int>(std::floor(uv.y() + 0.5));
  const std::size_t j = reference.index(x, y);
  const Vector3d d = reference.vertex(x, y), n = reference.normals[j];
  if (reference.depth_m[j] <= 0 || (s - d).norm() >= options.distance_gate_m || n.dot(normal) <= 0) return;
  if (n.cross(normal).norm() >= std::sin(options.normal_gate_deg * M_PI / 180)) return;
  const auto distance = [&](const Vector3d& point) { return n.dot(point - d); };
  const double weight = options.geometric_weight * reference.weight[j];
  add_row(sums.geometric, derivative(s, distance), distance(s), weight);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector6d moved = derivative(s, [axis](const Vector3d& point) { return point[axis]; });
    sums.displacement += weight * moved * moved.transpose();
  }
  sums.disagreement += weight * n.cross(normal).squaredNorm();
  sums.geometric_error_m2 += distance(s) * distance(s);
  ++sums.geometric_count;
}

// The reference's grey value between four pixels, where all of them have one and the nearest lies on the same surface.
std::optional<double> grey_at(const SurfaceImage& reference, const Vector2d& uv, double depth_m, double depth_gate_m) {
  const int x = static_cast<int>(std::floor(uv.x())), y = static_cast<int>(std::floor(uv.y()));
  if (x < 0 || y < 0 || x + 1 >= static_cast<int>(reference.camera.width) || y + 1 >= static_cast<int>(reference.camera.height))
    return std::nullopt;
  double grey = 0;
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 2; ++u) {
      const double value = reference.intensity[reference.index(x + u, y + v)];
      if (value < 0) return std::nullopt;
      grey += value * (1 - std::abs(uv.x() - x - u)) * (1 - std::abs(uv.y() - y - v));
    }
  const double z = reference.depth_m[reference.index(static_cast<int>(std::lround(uv.x())), static_cast<int>(std::lround(uv.y())))];
  if (z <= 0 || std::abs(z - depth_m) > depth_gate_m) return std::nullopt;
  return grey;
}

void add_photometry(TrackStep& sums, const SurfaceImage& reference, const Vector3d& s, double intensity, const Vector2d& gradient,
                    const TrackOptions& options) {
  const auto grey = grey_at(reference, project(reference.camera, s), s.z(), options.photometric_depth_gate_m);
  if (!grey) return;
  const double residual = intensity - *grey;
  // The reference changes along the motion as the frame does around its pixel.
  const Vector6d row = derivative(s, [&](const Vector3d& point) { return -gradient.dot(project(reference.camera, point)); });
  const double weight = 1 / (options.photometric_sigma + std::abs(residual));
  add_row(sums.photometric, row, residual, weight * weight);
  ++sums.photometric_count;
}

}  // namespace

TrackStep track_step_twin(const SurfaceImage& frame, const std::vector<Vector2d>& gradients, const SurfaceImage& reference,
                          const Rigid3& reference_from_camera, const TrackOptions& options, double gradient_min) {
  TrackStep sums;
  const int width = static_cast<int>(frame.camera.width), height = static_cast<int>(frame.camera.height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = frame.index(x, y);
      if (frame.depth_m[i] <= 0) continue;
      ++sums.surface_count;
      const Vector3d s = reference_from_camera * frame.vertex(x, y);
      if (s.z() < 0.05) continue;
      const Vector2d uv = project(reference.camera, s);
      if (uv.x() < -0.5 || uv.y() < -0.5 || uv.x() >= width - 0.5 || uv.y() >= height - 0.5) continue;
      add_geometry(sums, reference, s, reference_from_camera.rotation * frame.normals[i], options);
      if (gradients[i].norm() >= gradient_min) add_photometry(sums, reference, s, frame.intensity[i], gradients[i], options);
    }
  const double weight = sums.displacement(0, 0);
  if (weight > 0) sums.disagreement /= weight;
  const NormalEquations geometric =
      options.discount_normal_noise ? discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement) : sums.geometric;
  sums.step = (geometric.hessian + sums.photometric.hessian).ldlt().solve(geometric.right_hand_side + sums.photometric.right_hand_side);
  return sums;
}

}  // namespace hermite::test
