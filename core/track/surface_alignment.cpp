#include "core/track/surface_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/frame/frame_options.h"

namespace hermite::track {

namespace {

// Limits for pairs: distance, and cosine between normals. Following the wrong object turns the
// camera so that far surfaces move by up to 15 cm.
constexpr double kNear_m = 0.15, kAlikeCosine = 0.8;

// As in the odometry (shaders/track/odometry.comp): Student's t distribution for both residuals,
// and errors by pixels and edges.
constexpr double kDegreesOfFreedom = 5, kSaturated = 250, kBlur2 = 0.15 * 0.15;
constexpr double kLeastGeometric = 0.1, kLeastPhotometric = 1;

struct Sums {
  double count = 0, weighted = 0;
  double deviation() const { return std::sqrt(weighted / count); }
};

// Sums for the line grey = gain * known + offset.
struct Line {
  double one = 0, known = 0, known2 = 0, grey = 0, known_grey = 0;
};

}  // namespace

// A rigid transform whose rotation is a matrix, which is applied to a pixel faster than a
// quaternion.
struct SurfaceAlignment::Placement {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// Robust sums over resting surfaces, for the scales and the brightness of the next step.
struct SurfaceAlignment::Spread {
  Sums geometric, photometric;
  Line line;
};

SurfaceSystem sum_of_resting(const std::vector<SurfaceSystem>& systems,
                             const std::vector<bool>& moves) {
  SurfaceSystem sum;
  sum.hessian = kMotionPriorInformation * Matrix6d::Identity();
  for (std::size_t surface = 0; surface < systems.size(); ++surface) {
    if (moves[surface]) continue;
    sum.hessian += systems[surface].hessian;
    sum.right_hand_side += systems[surface].right_hand_side;
  }
  return sum;
}

ResidualScales scales_at_first(const frame::CoarseView& frame, const frame::CoarseView& earlier) {
  const auto mean = [](const frame::CoarseView& view) {
    double sum = 0;
    for (const float grey : view.grey) sum += std::clamp(double{grey}, 1.0, 255.0);
    return sum / static_cast<double>(view.size());
  };
  ResidualScales scales;
  scales.gain = std::clamp(mean(frame) / mean(earlier), 0.5, 2.0);
  return scales;
}

SurfaceAlignment::Pixel SurfaceAlignment::pixel_at(const frame::CoarseView& frame, int x, int y) {
  const std::size_t i = frame.index(x, y);
  Pixel pixel;
  pixel.point = frame.point(x, y);
  pixel.normal = frame.normals[i].cast<double>();
  pixel.uv = {x, y};
  const float left = frame.grey[i - 1], right = frame.grey[i + 1];
  const float above = frame.grey[frame.index(x, y - 1)], below = frame.grey[frame.index(x, y + 1)];
  pixel.gradient = {0.5 * (double{right} - double{left}), 0.5 * (double{below} - double{above})};
  const bool is_seen =
      std::min({left, right, above, below}) >= 0 && double{frame.grey[i]} <= kSaturated;
  pixel.grey = is_seen ? double{frame.grey[i]} : -1;
  return pixel;
}

SurfaceAlignment::SurfaceAlignment(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
                                   const frame::CoarseView& earlier)
    : first_of_surface_(surfaces.pixel_count.size() + 1, 0),
      earlier_(earlier),
      earlier_points_(frame::points_of(earlier)),
      earlier_normals_(earlier.size()) {
  for (std::size_t i = 0; i < earlier_normals_.size(); ++i)
    earlier_normals_[i] = earlier.normals[i].cast<double>();
  const int width = static_cast<int>(frame.camera.width),
            height = static_cast<int>(frame.camera.height);
  const auto for_each = [&](auto&& use) {
    for (int y = 1; y + 1 < height; ++y)
      for (int x = 1; x + 1 < width; ++x)
        if (frame.depth_m[frame.index(x, y)] > 0) use(x, y, surfaces.of_pixel[frame.index(x, y)]);
  };
  for_each([&](int, int, std::uint32_t surface) { ++first_of_surface_[surface + 1]; });
  std::partial_sum(first_of_surface_.begin(), first_of_surface_.end(), first_of_surface_.begin());
  pixels_.resize(first_of_surface_.back());
  std::vector<std::size_t> next = first_of_surface_;
  for_each([&](int x, int y, std::uint32_t surface) {
    pixels_[next[surface]++] = pixel_at(frame, x, y);
  });
}

// Returns the bilinear grey value; negative if it is outside or touches a pixel without a
// surface.
double SurfaceAlignment::earlier_grey_at(double u, double v) const {
  const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
  if (!earlier_.contains(x, y) || !earlier_.contains(x + 1, y + 1)) return -1;
  const double a = u - x, b = v - y;
  const float* above = &earlier_.grey[earlier_.index(x, y)];
  const float* below = above + earlier_.camera.width;
  if (std::min({above[0], above[1], below[0], below[1]}) < 0) return -1;
  return (1 - b) * ((1 - a) * double{above[0]} + a * double{above[1]}) +
         b * ((1 - a) * double{below[0]} + a * double{below[1]});
}

// Adds the pair of the pixel, if it has one.
void SurfaceAlignment::add(const Pixel& pixel, const Placement& earlier_from_frame,
                           const ResidualScales& scales, SurfaceSystem& system,
                           Spread& spread) const {
  const auto& [rotation, translation] = earlier_from_frame;
  const shared::Intrinsics& camera = earlier_.camera;
  const double fx = double{camera.fx}, fy = double{camera.fy};
  const Eigen::Vector3d point = rotation * pixel.point + translation;
  if (point.z() < 0.05) return;
  const double per_z = 1 / point.z(), u = fx * point.x() * per_z + double{camera.cx},
               v = fy * point.y() * per_z + double{camera.cy};
  const int x = static_cast<int>(std::floor(u + 0.5)), y = static_cast<int>(std::floor(v + 0.5));
  if (!earlier_.contains(x, y)) return;
  const std::size_t j = earlier_.index(x, y);
  if (earlier_.depth_m[j] <= 0) return;
  const Eigen::Vector3d &normal = earlier_normals_[j], away = point - earlier_points_[j];
  if (away.squaredNorm() > kNear_m * kNear_m || normal.dot(rotation * pixel.normal) < kAlikeCosine)
    return;
  const double per_noise = 1 / frame::kinect_noise_m(point.z());
  Vector6d row;
  row.head<3>() = per_noise * normal;
  row.tail<3>() = per_noise * point.cross(normal);
  const double residual = per_noise * normal.dot(away), scaled = residual / scales.geometric;
  const double likely = kDegreesOfFreedom / (kDegreesOfFreedom + scaled * scaled);
  system.add(row, residual, likely / (scales.geometric * scales.geometric));
  ++system.pairs;
  spread.geometric.count += 1;
  spread.geometric.weighted += likely * residual * residual;
  if (pixel.grey < 0 || std::abs(scaled) > 3) return;
  const double known = earlier_grey_at(u, v);
  if (known < 0 || known > kSaturated) return;
  const double flow =
      pixel.gradient.x() * (u - pixel.uv.x()) + pixel.gradient.y() * (v - pixel.uv.y());
  const double expected2 = 1 + kBlur2 * pixel.gradient.squaredNorm() + 0.09 * flow * flow,
               misfit = pixel.grey - (scales.gain * known + scales.offset);
  const double per_expected2 = 1 / (expected2 * scales.photometric * scales.photometric);
  const double grey_likely =
                   kDegreesOfFreedom / (kDegreesOfFreedom + misfit * misfit * per_expected2),
               weight = grey_likely * per_expected2;
  const double per_x = pixel.gradient.x() * fx * per_z, per_y = pixel.gradient.y() * fy * per_z;
  const Eigen::Vector3d slope(-per_x, -per_y, (per_x * point.x() + per_y * point.y()) * per_z);
  row.head<3>() = slope;
  row.tail<3>() = point.cross(slope);
  system.add(row, misfit, weight);
  spread.photometric.count += 1;
  spread.photometric.weighted += grey_likely * misfit * misfit / expected2;
  Line& line = spread.line;
  line.one += weight, line.known += weight * known, line.known2 += weight * known * known;
  line.grey += weight * pixel.grey, line.known_grey += weight * known * pixel.grey;
}

// Returns systems by surface; scales and brightness are updated from the resting ones.
std::vector<SurfaceSystem> SurfaceAlignment::linearise(const Rigid3& earlier_from_frame,
                                                       const std::vector<bool>& moves,
                                                       ResidualScales& scales) const {
  std::vector<SurfaceSystem> systems(surface_count());
  Spread spread;
  const Placement placement{earlier_from_frame.rotation.toRotationMatrix(),
                            earlier_from_frame.translation};
  for (std::size_t surface = 0; surface < systems.size(); ++surface) {
    if (moves[surface]) continue;
    for (std::size_t i = first_of_surface_[surface]; i < first_of_surface_[surface + 1]; ++i)
      add(pixels_[i], placement, scales, systems[surface], spread);
  }
  const auto& [geometric, photometric, line] = spread;
  // Scales only decrease: the first ones are wider than any noise.
  if (geometric.count > 0)
    scales.geometric = std::clamp(geometric.deviation(), kLeastGeometric, scales.geometric);
  if (photometric.count > 0)
    scales.photometric = std::clamp(photometric.deviation(), kLeastPhotometric, scales.photometric);
  const double spread2 = line.one * line.known2 - line.known * line.known;
  if (spread2 > 1e-3 * line.one * line.one) {
    scales.gain =
        std::clamp((line.one * line.known_grey - line.known * line.grey) / spread2, 0.5, 2.0);
    scales.offset = (line.grey - scales.gain * line.known) / line.one;
  }
  return systems;
}

SurfaceAlignment::Result SurfaceAlignment::align(const Rigid3& earlier_from_frame,
                                                 const ResidualScales& scales,
                                                 const std::vector<bool>& moves, int steps) const {
  Result result{earlier_from_frame, scales, {}};
  for (int step = 0; step < steps; ++step) {
    const SurfaceSystem rest =
        sum_of_resting(linearise(result.earlier_from_frame, moves, result.scales), moves);
    result.earlier_from_frame =
        exp_se3(rest.hessian.ldlt().solve(rest.right_hand_side)) * result.earlier_from_frame;
  }
  result.systems = linearise(result.earlier_from_frame, moves, result.scales);
  return result;
}

}  // namespace hermite::track
