#include "core/frame/retime.h"

#include <cmath>
#include <cstring>
#include <span>

#include "core/base/frame_helpers.h"
#include "core/frame/sampling.h"
#include "core/frame/shared_transform.h"

namespace hermite::frame {

namespace {

// In both directions: a thousand pixels of 640x480 tell a mean as well as all.
constexpr int kDifferenceStep = 16;

std::size_t pixels_of(const Camera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

// Returns, for each row of an image, the camera when the row is taken from the camera at the time
// stamp.
std::vector<shared::Transform> row_motions(int height_px, const Vector6d& twist_per_s,
                                           double readout_s, double delay_s) {
  std::vector<shared::Transform> rows;
  for (int row = 0; row < height_px; ++row)
    rows.push_back(
        to_shared(exp_se3(-(delay_s + readout_s * share_of_row(row, height_px)) * twist_per_s)));
  return rows;
}

}  // namespace

Retimer::Retimer(gpu::Device& device, const Camera& camera)
    : camera_(camera),
      params_{intrinsics_of(camera), static_cast<float>(1 / camera.depth_units_per_metre)},
      retime_depth_(device, "frame/retime_depth"),
      retime_color_(device, "frame/retime_color"),
      commands_(device),
      staged_(pixels_of(camera)),
      units_(device, (pixels_of(camera) + 1) / 2, "frame"),
      units_at_stamp_(device, units_.count(), "frame"),
      color_(device, pixels_of(camera), "frame"),
      color_at_stamp_(device, color_.count(), "frame"),
      depth_rows_(device, static_cast<std::size_t>(camera.height), "frame"),
      color_rows_(device, static_cast<std::size_t>(camera.height), "frame") {}

void Retimer::record_depth(const Vector6d& twist_per_s) {
  depth_rows_.upload(row_motions(camera_.height, twist_per_s, camera_.timing.depth_readout_s, 0));
  commands_.dispatch(
      retime_depth_, {static_cast<std::uint32_t>(units_.count())}, params_,
      {{"units", units_}, {"row_from_stamp", depth_rows_}, {"units_at_stamp", units_at_stamp_}});
}

void Retimer::record_color(const ColorImage& taken, const Vector6d& twist_per_s) {
  color_rows_.upload(row_motions(camera_.height, twist_per_s, camera_.timing.color_readout_s,
                                 camera_.timing.color_delay_s));
  for_pixels_of_frame(staged_.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Rgb8& c = taken.pixels[i];
      staged_[i] = shared::uint{c.r} | shared::uint{c.g} << 8 | shared::uint{c.b} << 16;
    }
  });
  color_.upload(staged_);
  commands_.dispatch(retime_color_, {params_.camera.width, params_.camera.height}, params_,
                     {{"units", moves_depth() ? units_at_stamp_ : units_},
                      {"color", color_},
                      {"row_from_stamp", color_rows_},
                      {"color_at_stamp", color_at_stamp_}});
}

RgbdFrame Retimer::apply(const RgbdFrame& frame, const Vector6d& twist_per_s) {
  const std::size_t depth_bytes = sizeof(std::uint16_t) * frame.depth.pixels.size();
  std::memcpy(staged_.data(), frame.depth.pixels.data(), depth_bytes);
  units_.upload(std::span(staged_).first(units_.count()));
  if (moves_depth()) record_depth(twist_per_s);
  if (moves_color()) record_color(frame.color, twist_per_s);
  commands_.submit_and_wait();

  RgbdFrame at_stamp = frame;
  if (moves_depth()) {
    units_at_stamp_.download_into(std::span(staged_).first(units_.count()));
    std::memcpy(at_stamp.depth.pixels.data(), staged_.data(), depth_bytes);
  }
  if (moves_color()) {
    color_at_stamp_.download_into(staged_);
    for_pixels_of_frame(staged_.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const shared::uint c = staged_[i];
        at_stamp.color.pixels[i] = {static_cast<std::uint8_t>(c), static_cast<std::uint8_t>(c >> 8),
                                    static_cast<std::uint8_t>(c >> 16)};
      }
    });
  }
  return at_stamp;
}

double retiming_difference_m(const Camera& camera, const DepthImage& depth, const Vector6d& a_per_s,
                             const Vector6d& b_per_s) {
  double sum_m2 = 0, count = 0;
  for (int y = kDifferenceStep / 2; y < depth.height; y += kDifferenceStep) {
    const double depth_s = camera.timing.depth_time_s(y, depth.height),
                 color_s = camera.timing.color_time_s(y, depth.height);
    const double time_s = std::abs(depth_s) > std::abs(color_s) ? depth_s : color_s;
    const Rigid3 by_a = exp_se3(-time_s * a_per_s), by_b = exp_se3(-time_s * b_per_s);
    for (int x = kDifferenceStep / 2; x < depth.width; x += kDifferenceStep) {
      const Eigen::Vector3d point_m =
          camera.unproject(x, y, depth.at(x, y) / camera.depth_units_per_metre);
      const Eigen::Vector3d a_m = by_a * point_m, b_m = by_b * point_m;
      if (depth.at(x, y) == 0 || a_m.z() <= 0 || b_m.z() <= 0) continue;
      sum_m2 += (a_m - b_m).squaredNorm();
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(sum_m2 / count) : 0;
}

Eigen::Vector2d color_pixel_at_stamp(const Camera& camera, const Eigen::Vector2d& pixel_px,
                                     const Eigen::Vector3d& point_m, const Vector6d& twist_per_s) {
  const Eigen::Vector3d when_taken =
      exp_se3(-camera.timing.color_time_s(pixel_px.y(), camera.height) * twist_per_s) * point_m;
  if (!(point_m.z() > 0 && when_taken.z() > 0)) return pixel_px;
  return pixel_px + camera.project(point_m) - camera.project(when_taken);
}

}  // namespace hermite::frame
