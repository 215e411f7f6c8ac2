#include "core/frame/retime.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/frame/color_between.h"

namespace hermite {

namespace {

// The row in which a point is seen depends on the time at which that row is taken, and its depth on where it is seen.
// Each step divides the error by about the readout over the time in which the image moves by its own height, 30 for a
// fast hand; at a grazing view by less.
constexpr int kDepthSteps = 5, kColorSteps = 2;
// As shares of the depth: an iteration has settled, and a ray whose iteration still changes by more lies between two
// surfaces.
constexpr float kSettled = 1e-4f, kUnsettled = 3e-3f;
// Ratio of depths above which neighbours lie on two surfaces.
constexpr float kOneSurface = 1.03f;

constexpr int kRowsAtOnce = 32;

// In both directions: a thousand pixels of 640x480 tell a mean as well as all.
constexpr int kDifferenceStep = 16;

// Calls work(y) for every row.
template <class Work>
void for_all_rows(int height_px, const Work& work) {
  const int stripes = (height_px + kRowsAtOnce - 1) / kRowsAtOnce;
  in_parallel(static_cast<std::size_t>(stripes), kThreadsOfFrame, [&](std::size_t stripe) {
    const int first = static_cast<int>(stripe) * kRowsAtOnce;
    for (int y = first; y < std::min(first + kRowsAtOnce, height_px); ++y) work(y);
  });
}

}  // namespace

Retimer::Retimer(const Camera& camera)
    : camera_(camera),
      focal_px_(static_cast<float>(camera.fx), static_cast<float>(camera.fy)),
      center_px_(static_cast<float>(camera.cx), static_cast<float>(camera.cy)),
      last_px_(static_cast<float>(camera.width - 1), static_cast<float>(camera.height - 1)),
      metres_per_depth_unit_(static_cast<float>(1 / camera.depth_units_per_metre)) {}

std::vector<Retimer::RowMotion> Retimer::motions(const Vector6d& twist_per_s, double readout_s, double delay_s) const {
  std::vector<RowMotion> row_from_stamp;
  for (int row = 0; row < camera_.height; ++row) {
    const Rigid3 motion = exp_se3(-(delay_s + readout_s * share_of_row(row, camera_.height)) * twist_per_s);
    row_from_stamp.push_back({motion.rotation.toRotationMatrix().cast<float>(), motion.translation.cast<float>()});
  }
  return row_from_stamp;
}

Eigen::Vector3f Retimer::ray(int x, int y) const {
  const Eigen::Vector2f pixel(static_cast<float>(x), static_cast<float>(y));
  return ((pixel - center_px_).array() / focal_px_.array()).matrix().homogeneous();
}

Eigen::Vector2f Retimer::pixel_of(const Eigen::Vector3f& direction) const {
  return (direction.head<2>().array() / direction.z() * focal_px_.array()).matrix() + center_px_;
}

// In the image, the inverse depth of a plane is linear. Returns the nearest pixel's depth between two surfaces.
float Retimer::depth_between_m(const DepthImage& depth, const Eigen::Vector2f& at_px) const {
  const int x = std::min(static_cast<int>(at_px.x()), depth.width - 2), y = std::min(static_cast<int>(at_px.y()), depth.height - 2);
  const float right = at_px.x() - static_cast<float>(x), down = at_px.y() - static_cast<float>(y);
  const std::uint16_t *above = &depth.at(x, y), *below = &depth.at(x, y + 1);
  const std::array<float, 4> units{static_cast<float>(above[0]), static_cast<float>(above[1]), static_cast<float>(below[0]),
                                   static_cast<float>(below[1])};
  const auto [least, greatest] = std::minmax({units[0], units[1], units[2], units[3]});
  if (least == 0 || greatest > kOneSurface * least)
    return units[(right >= 0.5f ? 1u : 0u) + (down >= 0.5f ? 2u : 0u)] * metres_per_depth_unit_;
  const float inverse_above = (1 - right) / units[0] + right / units[1], inverse_below = (1 - right) / units[2] + right / units[3];
  return metres_per_depth_unit_ / ((1 - down) * inverse_above + down * inverse_below);
}

// Returns the depth of a pixel at the time stamp; 0: unknown.
float Retimer::depth_m(const DepthImage& depth, int x, int y, const std::vector<RowMotion>& row_from_stamp) const {
  const Eigen::Vector3f straight = ray(x, y);
  Eigen::Vector2f at_px(static_cast<float>(x), static_cast<float>(y));
  float depth_m = static_cast<float>(depth.at(x, y)) * metres_per_depth_unit_, change_m = 0;
  for (int step = 0; step < kDepthSteps; ++step) {
    const auto& [rotation, translation_m] = row_from_stamp[static_cast<std::size_t>(at_px.y() + 0.5f)];
    const Eigen::Vector3f turned = rotation * straight;
    const Eigen::Vector3f direction = depth_m > 0 ? Eigen::Vector3f(depth_m * turned + translation_m) : turned;
    if (direction.z() <= 0) return 0;
    const Eigen::Vector2f wanted_px = pixel_of(direction);
    at_px = wanted_px.cwiseMax(0.0f).cwiseMin(last_px_);
    if ((wanted_px - at_px).lpNorm<Eigen::Infinity>() > 0.5f) return 0;
    const float measured_m = depth_between_m(depth, at_px);
    if (measured_m == 0) {
      if (depth_m == 0) return 0;
      change_m = depth_m;
      depth_m = 0;
      continue;
    }
    const Eigen::Vector3f point_m = measured_m / direction.z() * direction;
    const float here_m = std::max(0.0f, rotation.col(2).dot(point_m - translation_m));
    change_m = std::abs(here_m - depth_m);
    depth_m = here_m;
    if (change_m < kSettled * depth_m) return depth_m;
  }
  return change_m > kUnsettled * depth_m ? 0 : depth_m;
}

// `frame` has the depth of the time stamp and the colour as it was taken.
Rgb8 Retimer::color(const RgbdFrame& frame, int x, int y, const std::vector<RowMotion>& row_from_stamp) const {
  const Eigen::Vector3f straight = ray(x, y);
  const float depth_m = static_cast<float>(frame.depth.at(x, y)) * metres_per_depth_unit_;
  Eigen::Vector2f at_px(static_cast<float>(x), static_cast<float>(y));
  // Inside the last pixels, between which can be interpolated.
  const Eigen::Vector2f most_px = last_px_.array() - 1.0f / 256;
  for (int step = 0; step < kColorSteps; ++step) {
    const auto& [rotation, translation_m] = row_from_stamp[static_cast<std::size_t>(at_px.y() + 0.5f)];
    const Eigen::Vector3f turned = rotation * straight;
    const Eigen::Vector3f direction = depth_m > 0 ? Eigen::Vector3f(depth_m * turned + translation_m) : turned;
    if (direction.z() > 0) at_px = pixel_of(direction).cwiseMax(0.0f).cwiseMin(most_px);
  }
  return color_between(frame.color, at_px.x(), at_px.y());
}

RgbdFrame Retimer::apply(const RgbdFrame& frame, const Vector6d& twist_per_s) const {
  const ImageTiming& timing = camera_.timing;
  RgbdFrame result = frame;
  if (timing.depth_readout_s != 0) {
    const std::vector<RowMotion> row_from_stamp = motions(twist_per_s, timing.depth_readout_s, 0);
    for_all_rows(camera_.height, [&](int y) {
      for (int x = 0; x < camera_.width; ++x) {
        const float units = std::round(depth_m(frame.depth, x, y, row_from_stamp) / metres_per_depth_unit_);
        result.depth.at(x, y) = units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
      }
    });
  }
  if (timing.color_readout_s == 0 && timing.color_delay_s == 0) return result;
  const std::vector<RowMotion> row_from_stamp = motions(twist_per_s, timing.color_readout_s, timing.color_delay_s);
  ColorImage color_at_stamp(camera_.width, camera_.height);
  for_all_rows(camera_.height, [&](int y) {
    for (int x = 0; x < camera_.width; ++x) color_at_stamp.at(x, y) = color(result, x, y, row_from_stamp);
  });
  result.color = std::move(color_at_stamp);
  return result;
}

double Retimer::difference_m(const DepthImage& depth, const Vector6d& a_per_s, const Vector6d& b_per_s) const {
  const ImageTiming& timing = camera_.timing;
  double sum_m2 = 0, count = 0;
  for (int y = kDifferenceStep / 2; y < depth.height; y += kDifferenceStep) {
    const double depth_s = timing.depth_time_s(y, depth.height), color_s = timing.color_time_s(y, depth.height);
    const double time_s = std::abs(depth_s) > std::abs(color_s) ? depth_s : color_s;
    const Rigid3 by_a = exp_se3(-time_s * a_per_s), by_b = exp_se3(-time_s * b_per_s);
    for (int x = kDifferenceStep / 2; x < depth.width; x += kDifferenceStep) {
      const Eigen::Vector3d point_m = (depth.at(x, y) / camera_.depth_units_per_metre) * ray(x, y).cast<double>();
      const Eigen::Vector3d a_m = by_a * point_m, b_m = by_b * point_m;
      if (depth.at(x, y) == 0 || a_m.z() <= 0 || b_m.z() <= 0) continue;
      sum_m2 += (a_m - b_m).squaredNorm();
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(sum_m2 / count) : 0;
}

Eigen::Vector2d Retimer::color_pixel_at_stamp(const Eigen::Vector2d& pixel_px, const Eigen::Vector3d& point_m,
                                              const Vector6d& twist_per_s) const {
  const double time_s = camera_.timing.color_time_s(pixel_px.y(), camera_.height);
  const Eigen::Vector3d when_taken = exp_se3(-time_s * twist_per_s) * point_m;
  if (!(point_m.z() > 0 && when_taken.z() > 0)) return pixel_px;
  return pixel_px + camera_.project(point_m) - camera_.project(when_taken);
}

std::optional<Retimer> retimer_of(const Camera& camera) {
  if (camera.timing == ImageTiming{}) return std::nullopt;
  return Retimer(camera);
}

}  // namespace hermite
