#include "tests/reference/track_twin.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/frame/frame_options.h"

namespace hermite::test {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d project(const shared::Intrinsics& c, const Vector3d& p) {
  return {c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy};
}

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

void add_row(track::NormalEquations& sums, const Vector6d& row, double residual, double weight) {
  sums.hessian += weight * row * row.transpose();
  sums.right_hand_side -= weight * residual * row;
}

// Student's t distribution with five degrees of freedom, 1 at zero.
double likelihood(double residual_in_scales) {
  return 5 / (5 + residual_in_scales * residual_in_scales);
}

// As FrameOptions has it: the noise of a Kinect v1.
double noise_m(double depth_m) {
  const frame::FrameOptions noise;
  const double beyond_m = std::max(0.0, depth_m - 0.4);
  return noise.noise_floor_m + noise.noise_growth_per_m * beyond_m * beyond_m;
}

// Returns whether both are so near that they have their image in common.
bool add_geometry(TrackStep& sums, const SurfaceImage& reference, const Vector3d& s,
                  const Vector3d& normal, double depth_m, const track::TrackOptions& options,
                  const BelievedResiduals& believed) {
  const Vector2d uv = project(reference.camera, s);
  const int x = static_cast<int>(std::floor(uv.x() + 0.5)),
            y = static_cast<int>(std::floor(uv.y() + 0.5));
  const std::size_t j = reference.index(x, y);
  const Vector3d d = reference.vertex(x, y), n = reference.normals[j];
  if (reference.depth_m[j] <= 0 || (s - d).norm() >= options.distance_gate_m || n.dot(normal) <= 0)
    return false;
  if (n.cross(normal).norm() >= std::sin(options.normal_gate_deg * M_PI / 180)) return false;
  const auto distance = [&](const Vector3d& point) { return n.dot(point - d); };
  const double residual_in_scales = distance(s) / (noise_m(depth_m) * believed.geometric_scale);
  const double weight =
      options.geometric_weight * reference.weight[j] * likelihood(residual_in_scales);
  add_row(sums.geometric, derivative(s, distance), distance(s), weight);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector6d moved = derivative(s, [axis](const Vector3d& point) { return point[axis]; });
    sums.displacement += weight * moved * moved.transpose();
  }
  sums.disagreement += weight * n.cross(normal).squaredNorm();
  sums.geometric_error_m2 += distance(s) * distance(s);
  ++sums.geometric_count;
  return std::abs(residual_in_scales) < options.photometric_gate;
}

// The reference's grey value between four pixels, where all of them have one and the nearest lies
// on the same surface.
std::optional<double> grey_at(const SurfaceImage& reference, const Vector2d& uv, double depth_m,
                              double depth_gate_m) {
  const int x = static_cast<int>(std::floor(uv.x())), y = static_cast<int>(std::floor(uv.y()));
  if (x < 0 || y < 0 || x + 1 >= static_cast<int>(reference.camera.width) ||
      y + 1 >= static_cast<int>(reference.camera.height))
    return std::nullopt;
  double grey = 0;
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 2; ++u) {
      const double value = reference.intensity[reference.index(x + u, y + v)];
      if (value < 0) return std::nullopt;
      grey += value * (1 - std::abs(uv.x() - x - u)) * (1 - std::abs(uv.y() - y - v));
    }
  const double z = reference.depth_m[reference.index(static_cast<int>(std::lround(uv.x())),
                                                     static_cast<int>(std::lround(uv.y())))];
  if (z <= 0 || std::abs(z - depth_m) > depth_gate_m) return std::nullopt;
  return grey;
}

void add_photometry(TrackStep& sums, const SurfaceImage& reference, const Vector3d& s,
                    double intensity, const Vector2d& gradient, const track::TrackOptions& options,
                    const BelievedResiduals& believed) {
  constexpr double kSaturated = 250;
  const Vector2d uv = project(reference.camera, s);
  const auto grey = grey_at(reference, uv, s.z(), options.photometric_depth_gate_m);
  if (!grey || intensity > kSaturated) return;
  const double residual = intensity - *grey;
  // The reference changes along the motion as the frame does around its pixel.
  const Vector6d row = derivative(
      s, [&](const Vector3d& point) { return -gradient.dot(project(reference.camera, point)); });
  const std::size_t nearest = reference.index(static_cast<int>(std::floor(uv.x() + 0.5)),
                                              static_cast<int>(std::floor(uv.y() + 0.5)));
  const double z = reference.depth_m[nearest], confidence = reference.weight[nearest] * z * z;
  // Meant at a spread of 4 grey values; across an edge 0.3 pixels more.
  const double sigma = options.photometric_sigma * believed.photometric_scale / 4;
  const double expected2 = 1 + gradient.squaredNorm() * 0.075 * 0.075;
  const double weight = std::min(1.0, confidence / options.mature_confidence) /
                        (sigma * sigma * expected2) *
                        likelihood(residual / std::sqrt(expected2) / believed.photometric_scale);
  add_row(sums.photometric.motion, row, residual, weight);
  const Eigen::Vector2d brightness(-*grey, -1);  // derivative by gain and offset
  sums.photometric.mixed += weight * row * brightness.transpose();
  sums.photometric.hessian += weight * brightness * brightness.transpose();
  sums.photometric.right_hand_side -= weight * residual * brightness;
  ++sums.photometric_count;
}

}  // namespace

TrackStep track_step_twin(const SurfaceImage& frame, const std::vector<Vector2d>& gradients,
                          const SurfaceImage& reference, const Rigid3& reference_from_camera,
                          const track::TrackOptions& options, const BelievedResiduals& believed,
                          double gradient_min) {
  TrackStep sums;
  const int width = static_cast<int>(frame.camera.width),
            height = static_cast<int>(frame.camera.height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = frame.index(x, y);
      if (frame.depth_m[i] <= 0) continue;
      ++sums.surface_count;
      const Vector3d s = reference_from_camera * frame.vertex(x, y);
      if (s.z() < 0.05) continue;
      const Vector2d uv = project(reference.camera, s);
      if (uv.x() < -0.5 || uv.y() < -0.5 || uv.x() >= width - 0.5 || uv.y() >= height - 0.5)
        continue;
      const Vector3d normal = reference_from_camera.rotation * frame.normals[i];
      const bool same =
          add_geometry(sums, reference, s, normal, frame.depth_m[i], options, believed);
      if (same && gradients[i].norm() >= gradient_min)
        add_photometry(sums, reference, s, frame.intensity[i], gradients[i], options, believed);
    }
  const double weight = sums.displacement(0, 0);
  if (weight > 0) sums.disagreement /= weight;
  const track::NormalEquations geometric =
      options.discount_normal_noise
          ? track::discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement)
          : sums.geometric;
  const track::NormalEquations photometric = track::without_brightness(sums.photometric, {});
  sums.step = (geometric.hessian + photometric.hessian)
                  .ldlt()
                  .solve(geometric.right_hand_side + photometric.right_hand_side);
  return sums;
}

}  // namespace hermite::test
