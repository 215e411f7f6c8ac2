#include "tests/reference/frame_twin.h"

#include <Eigen/Geometry>
#include <cmath>

namespace hermite::test {

namespace {

using Eigen::Vector3d;

constexpr int kWindow = 3;                     // half side of the window of the frame's HRBF
constexpr int kMinKernels = 16;                // of 49, as the authors' program has it
constexpr double kKinectFocalLength_px = 525;  // that the paper's epsilon is made for
// 2 * 0.6^2 of the distortion term (Keller et al. 2013).
constexpr double kTwoSigma2 = 0.72;

bool inside(const shared::Intrinsics& camera, int x, int y) {
  return x >= 0 && y >= 0 && x < static_cast<int>(camera.width) &&
         y < static_cast<int>(camera.height);
}

std::size_t index(const shared::Intrinsics& camera, int x, int y) {
  return static_cast<std::size_t>(y) * camera.width + static_cast<std::size_t>(x);
}

// Calls body(x, y, index) for every pixel.
template <class Body>
void for_each_pixel(const shared::Intrinsics& camera, Body body) {
  for (int y = 0; y < static_cast<int>(camera.height); ++y)
    for (int x = 0; x < static_cast<int>(camera.width); ++x) body(x, y, index(camera, x, y));
}

// t <- sum w n.p / sum w n.ray with w = s^3 / r^2, once.
double one_step(const std::vector<HrbfKernel>& kernels, const Vector3d& ray, double t) {
  double plane = 0, slope = 0;
  for (const HrbfKernel& kernel : kernels) {
    const double s = std::max(0.0, 1 - (t * ray - kernel.position_m).norm() / kernel.radius_m);
    const double w = s * s * s / (kernel.radius_m * kernel.radius_m);
    plane += w * kernel.normal.dot(kernel.position_m);
    slope += w * kernel.normal.dot(ray);
  }
  return slope != 0 ? plane / slope : t;
}

// The kernels of the window around (x, y) that lie on the same surface. `own` becomes the index of
// the centre's.
std::vector<HrbfKernel> window(const SurfaceImage& first, int x, int y,
                               const frame::FrameOptions& options, std::size_t& own) {
  std::vector<HrbfKernel> kernels;
  const double centre_m = static_cast<double>(first.depth_m[first.index(x, y)]);
  for (int v = y - kWindow; v <= y + kWindow; ++v)
    for (int u = x - kWindow; u <= x + kWindow; ++u) {
      if (!inside(first.camera, u, v)) continue;
      const std::size_t i = first.index(u, v);
      const double z = static_cast<double>(first.depth_m[i]);
      if (first.normals[i].isZero() || z <= 0 || std::abs(z - centre_m) >= options.depth_gate_m)
        continue;
      if (u == x && v == y) own = kernels.size();
      kernels.push_back(
          {first.vertex(u, v), first.normals[i],
           support_radius_m(first.camera, options.support_radius_scale, z, first.normals[i].z())});
    }
  return kernels;
}

double distortion(const shared::Intrinsics& camera, int x, int y) {
  const double dx = x - static_cast<double>(camera.cx), dy = y - static_cast<double>(camera.cy);
  const double half_diagonal2 = 0.25 * (static_cast<double>(camera.width) * camera.width +
                                        static_cast<double>(camera.height) * camera.height);
  return std::exp(-(dx * dx + dy * dy) / half_diagonal2 / kTwoSigma2);
}

}  // namespace

double support_radius_m(const shared::Intrinsics& camera, double scale, double depth_m,
                        double normal_z) {
  const double focal_px = 0.5 * (static_cast<double>(camera.fx) + static_cast<double>(camera.fy));
  return scale * std::sqrt(2.0) * depth_m / focal_px * std::min(2.0, 1 / std::abs(normal_z));
}

std::vector<double> bilateral_twin(const std::vector<float>& raw_depth_m,
                                   const shared::Intrinsics& camera,
                                   const frame::FrameOptions& options) {
  std::vector<double> filtered(raw_depth_m.size());
  const int radius = static_cast<int>(std::lround(options.bilateral_sigma_space_px * 4 / 3));
  const double space2 = 2 * options.bilateral_sigma_space_px * options.bilateral_sigma_space_px;
  for_each_pixel(camera, [&](int x, int y, std::size_t i) {
    const double centre = static_cast<double>(raw_depth_m[i]);
    if (centre <= 0) return;
    const double beyond = std::max(0.0, centre - 0.4);
    const double sigma_m = options.bilateral_noise_sigmas *
                           (options.noise_floor_m + options.noise_growth_per_m * beyond * beyond);
    const double sigma_per_m = sigma_m / (centre * centre);
    double sum = 0, weights = 0;
    for (int v = y - radius; v <= y + radius; ++v)
      for (int u = x - radius; u <= x + radius; ++u) {
        const double z =
            inside(camera, u, v) ? static_cast<double>(raw_depth_m[index(camera, u, v)]) : 0;
        if (z <= 0) continue;
        const double difference = (1 / z - 1 / centre) / sigma_per_m;
        const double w = std::exp(-((u - x) * (u - x) + (v - y) * (v - y)) / space2 -
                                  difference * difference / 2);
        sum += w / z;
        weights += w;
      }
    filtered[i] = weights / sum;
  });
  return filtered;
}

std::vector<Vector3d> normals_twin(const std::vector<float>& depth_m,
                                   const shared::Intrinsics& camera, double depth_gate_m) {
  SurfaceImage image(camera);
  image.depth_m = depth_m;
  for_each_pixel(camera, [&](int x, int y, std::size_t i) {
    const double z = static_cast<double>(depth_m[i]);
    if (z <= 0) return;
    // The neighbour where it lies on the same surface, else the pixel itself.
    const auto end = [&](int u, int v) {
      if (!inside(camera, u, v)) return image.vertex(x, y);
      const double other = static_cast<double>(depth_m[image.index(u, v)]);
      return other > 0 && std::abs(other - z) < depth_gate_m ? image.vertex(u, v)
                                                             : image.vertex(x, y);
    };
    const Vector3d normal = (end(x + 1, y) - end(x - 1, y)).cross(end(x, y + 1) - end(x, y - 1));
    if (normal.norm() > 1e-10 && normal.z() > 0) image.normals[i] = normal.normalized();
  });
  return image.normals;
}

SurfaceImage surface_twin(const std::vector<float>& depth_m, const std::vector<Vector3d>& normals,
                          const shared::Intrinsics& camera, const frame::FrameOptions& options) {
  SurfaceImage first(camera), out(camera);
  first.depth_m = depth_m;
  first.normals = normals;
  for_each_pixel(camera, [&](int x, int y, std::size_t i) {
    if (first.normals[i].isZero() || depth_m[i] <= 0) return;
    std::size_t own = 0;
    const std::vector<HrbfKernel> kernels = window(first, x, y, options, own);
    double z = static_cast<double>(depth_m[i]);
    if (options.project_to_surface) {
      const double moved = one_step(kernels, first.ray(x, y), z);
      if (std::abs(moved - z) < 0.5 * kernels[own].radius_m) z = moved;
    }
    const HrbfSample sample = evaluate_hrbf(kernels, z * first.ray(x, y), own);
    const auto curvatures = principal_curvatures(sample.gradient, sample.hessian);
    if (sample.support_count < kMinKernels || !curvatures || sample.gradient.z() <= 0 ||
        sample.gradient.dot(first.ray(x, y)) <= 0)
      return;
    if (std::max(std::abs(curvatures->max_per_m), std::abs(curvatures->min_per_m)) >=
        options.curvature_limit_per_m)
      return;
    out.depth_m[i] = static_cast<float>(z);
    out.normals[i] = sample.gradient.normalized();
    out.curvatures[i] = {curvatures->max_per_m, curvatures->min_per_m};
    const double epsilon = options.confidence_epsilon * camera.fx / kKinectFocalLength_px;
    const double gradient = std::abs(sample.gradient.dot(kernels[own].normal));
    const double hrbf = options.hrbf_confidence ? std::exp(-epsilon / std::sqrt(gradient)) : 1;
    out.weight[i] = static_cast<float>(hrbf * distortion(camera, x, y));
  });
  return out;
}

SurfaceImage downsample_twin(const SurfaceImage& fine, const shared::Intrinsics& coarse_camera,
                             double depth_gate_m) {
  SurfaceImage coarse(coarse_camera);
  for_each_pixel(coarse_camera, [&](int x, int y, std::size_t i) {
    double depth = 0, weight = 0, grey = 0;
    float nearest = 1e9f, farthest = 0, darkest = 1e9f;
    Vector3d normal = Vector3d::Zero();
    Eigen::Vector2d curvatures = Eigen::Vector2d::Zero();
    for (const std::size_t j : {fine.index(2 * x, 2 * y), fine.index(2 * x + 1, 2 * y),
                                fine.index(2 * x, 2 * y + 1), fine.index(2 * x + 1, 2 * y + 1)}) {
      nearest = std::min(nearest, fine.depth_m[j]);
      farthest = std::max(farthest, fine.depth_m[j]);
      darkest = std::min(darkest, fine.intensity[j]);
      depth += 0.25 * static_cast<double>(fine.depth_m[j]);
      weight += 0.25 * static_cast<double>(fine.weight[j]);
      grey += 0.25 * static_cast<double>(fine.intensity[j]);
      normal += fine.normals[j];
      curvatures += 0.25 * fine.curvatures[j];
    }
    coarse.intensity[i] = darkest >= 0 ? static_cast<float>(grey) : -1.0f;
    if (nearest <= 0 || static_cast<double>(farthest - nearest) >= depth_gate_m) return;
    coarse.depth_m[i] = static_cast<float>(depth);
    coarse.weight[i] = static_cast<float>(weight);
    coarse.normals[i] = normal.normalized();
    coarse.curvatures[i] = curvatures;
  });
  return coarse;
}

std::vector<Eigen::Vector2d> gradient_twin(const std::vector<float>& intensity,
                                           const shared::Intrinsics& camera) {
  constexpr double kSobel[3][3] = {{-1, 0, 1}, {-2, 0, 2}, {-1, 0, 1}};
  std::vector<Eigen::Vector2d> gradient(intensity.size(), Eigen::Vector2d::Zero());
  for_each_pixel(camera, [&](int x, int y, std::size_t i) {
    if (!inside(camera, x - 1, y - 1) || !inside(camera, x + 1, y + 1)) return;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u)
        gradient[i] += static_cast<double>(intensity[index(camera, x + u, y + v)]) / 8 *
                       Eigen::Vector2d(kSobel[v + 1][u + 1], kSobel[u + 1][v + 1]);
  });
  return gradient;
}

}  // namespace hermite::test
