#include "tests/support/analytic_scene.h"

#include <Eigen/Geometry>
#include <cmath>

namespace hermite::test {

namespace {

using Eigen::Vector3d;

constexpr double kWaveX_m = 0.06, kWaveX_per_m = 7, kWaveY_m = 0.05, kWaveY_per_m = 9;

double wave_height_m(double x, double y) {
  return kWaveX_m * std::sin(kWaveX_per_m * x + 0.4) +
         kWaveY_m * std::cos(kWaveY_per_m * y + 2 * x);
}

Vector3d wave_normal(double x, double y) {
  const double along_x = kWaveX_m * kWaveX_per_m * std::cos(kWaveX_per_m * x + 0.4) -
                         2 * kWaveY_m * std::sin(kWaveY_per_m * y + 2 * x);
  const double along_y = -kWaveY_m * kWaveY_per_m * std::sin(kWaveY_per_m * y + 2 * x);
  return Vector3d(-along_x, -along_y, 1).normalized();
}

// sign -1: the near side of the sphere, +1 the far one.
Scene ball(const Vector3d& centre_m, double radius_m, double sign) {
  return [=](const Vector3d& origin_m, const Vector3d& direction) -> std::optional<SceneHit> {
    const Vector3d d = direction.normalized(), to_centre = centre_m - origin_m;
    const double along = d.dot(to_centre),
                 squared = along * along - to_centre.squaredNorm() + radius_m * radius_m;
    if (squared < 0) return std::nullopt;
    const Vector3d hit = origin_m + (along + sign * std::sqrt(squared)) * d;
    return SceneHit{hit, sign * (hit - centre_m) / radius_m};
  };
}

}  // namespace

Scene plane_scene(double depth_m, double tilt_rad) {
  const Vector3d n(std::sin(tilt_rad), 0, std::cos(tilt_rad));
  return [=](const Vector3d& origin_m, const Vector3d& direction) -> std::optional<SceneHit> {
    const double t = (n.z() * depth_m - n.dot(origin_m)) / n.dot(direction);
    if (!(t > 0)) return std::nullopt;
    return SceneHit{origin_m + t * direction, n};
  };
}

Scene sphere_scene(double depth_m, double radius_m) {
  return ball({0, 0, depth_m + radius_m}, radius_m, -1);
}

Scene bowl_scene(double depth_m, double radius_m) {
  return ball({0, 0, depth_m - radius_m}, radius_m, 1);
}

Scene wave_scene(double depth_m) {
  return [=](const Vector3d& origin_m, const Vector3d& direction) -> std::optional<SceneHit> {
    double t = (depth_m - origin_m.z()) / direction.z();
    Vector3d p, n;
    for (int i = 0; i < 50; ++i) {  // Newton; the waves are flat enough for it
      p = origin_m + t * direction;
      n = wave_normal(p.x(), p.y());
      const double step =
          n.z() * (p.z() - depth_m - wave_height_m(p.x(), p.y())) / n.dot(direction);
      t -= step;
      if (std::abs(step) < 1e-14) break;
    }
    return SceneHit{p, n};
  };
}

double texture(const Vector3d& p) {
  return 128 + 50 * std::sin(21 * p.x() + 3 * p.y()) + 50 * std::cos(25 * p.y() - 4 * p.x());
}

SurfaceImage render(const Scene& scene, const shared::Intrinsics& camera,
                    const Rigid3& world_from_camera) {
  SurfaceImage image(camera);
  const Eigen::Quaterniond camera_from_world = world_from_camera.rotation.conjugate();
  for (int y = 0; y < static_cast<int>(camera.height); ++y)
    for (int x = 0; x < static_cast<int>(camera.width); ++x) {
      const Vector3d ray = image.ray(x, y);
      const auto hit = scene(world_from_camera.translation, world_from_camera.rotation * ray);
      if (!hit) continue;
      const std::size_t i = image.index(x, y);
      image.depth_m[i] = static_cast<float>((inverse(world_from_camera) * hit->position_m).z());
      image.normals[i] = camera_from_world * hit->normal;
      image.weight[i] = 1;
      image.intensity[i] = static_cast<float>(texture(hit->position_m));
    }
  return image;
}

DepthImage render_depth(const Scene& scene, const Camera& camera) {
  DepthImage depth(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto hit = scene(Vector3d::Zero(), camera.unproject(x, y, 1));
      const double units = hit ? std::round(hit->position_m.z() * camera.depth_units_per_metre) : 0;
      depth.at(x, y) = static_cast<std::uint16_t>(units > 65535 ? 0 : units);
    }
  return depth;
}

frame::RgbdFrame grey_frame(DepthImage depth, Rgb8 color) {
  frame::RgbdFrame frame{0, std::move(depth), {}};
  frame.color = ColorImage(frame.depth.width, frame.depth.height);
  for (Rgb8& pixel : frame.color.pixels) pixel = color;
  return frame;
}

}  // namespace hermite::test
