#include "core/frame/color_registration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/frame/color_between.h"

namespace hermite::frame {

namespace {

using InverseDepths = Image<float>;  // 1/m

// Farther than everything, so that a block with any depth never keeps it.
constexpr float kUnknown = std::numeric_limits<float>::infinity();
// A point with a smaller inverse depth in the colour camera, or behind it, has no projection: it is
// beyond 1 km, or the lens model is invalid there.
constexpr float kLeastForward = 1e-3f;

const ColorCamera& color_of(const Camera& camera) {
  CHECK(camera.color.has_value(), "the camera has no separate colour camera");
  return *camera.color;
}

Eigen::Matrix3f ray_from_pixel(const Camera& camera) {
  Eigen::Matrix3d pixel_from_ray;
  pixel_from_ray << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d rotation =
      color_of(camera).color_from_depth.rotation.normalized().toRotationMatrix();
  return (rotation * pixel_from_ray.inverse()).cast<float>();
}

// Halves rows and columns, rounding up; keeps the farthest known depth of four.
InverseDepths halved(const InverseDepths& fine) {
  InverseDepths coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      const int left = 2 * x, top = 2 * y, right = std::min(left + 1, fine.width - 1),
                bottom = std::min(top + 1, fine.height - 1);
      coarse.at(x, y) = std::min(std::min(fine.at(left, top), fine.at(right, top)),
                                 std::min(fine.at(left, bottom), fine.at(right, bottom)));
    }
  return coarse;
}

// Fills all unknown pixels; 0, infinitely far, if the whole image is unknown.
void fill(InverseDepths& fine) {
  if (fine.width == 1 && fine.height == 1) {
    if (fine.pixels[0] == kUnknown) fine.pixels[0] = 0;
    return;
  }
  InverseDepths coarse = halved(fine);
  fill(coarse);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      if (float& value = fine.at(x, y); value == kUnknown) value = coarse.at(x / 2, y / 2);
}

InverseDepths filled_inverse_depths(const DepthImage& depth, float metres_per_depth_unit) {
  InverseDepths inverse_depths(depth.width, depth.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    inverse_depths.pixels[i] =
        depth.pixels[i] == 0 ? kUnknown
                             : 1 / (static_cast<float>(depth.pixels[i]) * metres_per_depth_unit);
  fill(inverse_depths);
  return inverse_depths;
}

// Clamps projections outside the image, so that casts to int stay in range.
constexpr float kOutside_px = 2;

// Half the distance between neighbouring projections plus half a pixel for rounding, so that a
// surface leaves no column uncovered.
int reach_px(const Camera& camera) {
  return static_cast<int>(std::ceil(0.5 * camera.color->fx / camera.fx + 0.5));
}

// Returns the least inverse-depth difference of an occlusion. Beside a near object, on the side
// where it occludes nothing, its own columns may cover those of a point. Their pixels were at least
// one apart before parallax, so only a parallax difference larger than two columns plus the reach
// is an occlusion. Without parallax it is infinite.
float hiding_per_m(const ColorCamera& color, int reach_px) {
  return static_cast<float>((reach_px + 2) /
                            (color.fx * std::abs(color.color_from_depth.translation.x())));
}

}  // namespace

ColorRegistration::ColorRegistration(const Camera& camera)
    : width_(camera.width),
      height_(camera.height),
      metres_per_depth_unit_(static_cast<float>(1 / camera.depth_units_per_metre)),
      distortion_(color_of(camera).distortion),
      is_distorted_(distortion_ != Distortion{}),
      fx_(static_cast<float>(camera.color->fx)),
      fy_(static_cast<float>(camera.color->fy)),
      cx_(static_cast<float>(camera.color->cx)),
      cy_(static_cast<float>(camera.color->cy)),
      ray_from_pixel_(ray_from_pixel(camera)),
      depth_camera_m_(camera.color->color_from_depth.translation.cast<float>()),
      columns_(Eigen::ArrayXf::LinSpaced(camera.width, 0.0f, static_cast<float>(camera.width - 1))),
      reach_px_(reach_px(camera)),
      margin_px_(static_cast<int>(kOutside_px) + reach_px_ + 1),
      hiding_per_m_(hiding_per_m(*camera.color, reach_px_)) {}

void ColorRegistration::find_places(const InverseDepths& inverse_depths, int y, Row& row) const {
  const Eigen::Vector3f first =
                            ray_from_pixel_.col(1) * static_cast<float>(y) + ray_from_pixel_.col(2),
                        step = ray_from_pixel_.col(0);
  const Eigen::Map<const Eigen::ArrayXf> inverse_depth(&inverse_depths.at(0, y), width_);
  const auto coordinate = [&](int i) {
    return first[i] + step[i] * columns_ + depth_camera_m_[i] * inverse_depth;
  };
  const Eigen::ArrayXf forward = coordinate(2), scale = forward.max(kLeastForward).inverse();
  row.u = coordinate(0) * scale;
  row.v = coordinate(1) * scale;
  if (is_distorted_)
    for (int x = 0; x < width_; ++x) {
      const Eigen::Vector2f at = distortion_.apply(row.u[x], row.v[x]).cast<float>();
      row.u[x] = at.x(), row.v[x] = at.y();
    }
  row.u = (row.u * fx_ + cx_).max(-kOutside_px).min(static_cast<float>(width_) + kOutside_px);
  row.v = (row.v * fy_ + cy_).max(-kOutside_px).min(static_cast<float>(height_) + kOutside_px);
  if (forward.minCoeff() > kLeastForward) return;
  for (int x = 0; x < width_; ++x)
    if (!(forward[x] > kLeastForward)) row.u[x] = row.v[x] = -kOutside_px;
}

// Finds occluded pixels of a row: only measured depth occludes, and only points in the colour image
// are tested.
void ColorRegistration::find_hidden(const InverseDepths& inverse_depths, const DepthImage& depth,
                                    int y, Row& row) const {
  constexpr int kOutside = static_cast<int>(kOutside_px);
  const std::uint16_t* measured = &depth.at(0, y);
  const float* inverse_depth = &inverse_depths.at(0, y);
  row.nearest_per_m.setZero();
  float* nearest = row.nearest_per_m.data() + margin_px_;
  for (int x = 0; x < width_; ++x) {
    if (measured[x] == 0) continue;
    const int column = static_cast<int>(row.u[x] + (kOutside_px + 0.5f)) - kOutside;
    nearest[column] = std::max(nearest[column], inverse_depth[x]);
  }
  row.covering_per_m.setZero();
  for (int offset = -reach_px_; offset <= reach_px_ + 1; ++offset)
    row.covering_per_m =
        row.covering_per_m.max(row.nearest_per_m.segment(margin_px_ + offset, width_));
  for (int x = 0; x < width_; ++x) {
    const int left = static_cast<int>(row.u[x]);
    row.is_hidden[static_cast<std::size_t>(x)] =
        row.u[x] >= 0 && left + 1 < width_ &&
        row.covering_per_m[left] - inverse_depth[x] > hiding_per_m_;
  }
}

// Gives occluded stretches of a row the colour of their farther end.
void ColorRegistration::uncover(const InverseDepths& inverse_depths, int y, const Row& row,
                                ColorImage& registered) const {
  const auto nearness = [&](int x) {
    return x < 0 || x == width_ ? kUnknown : inverse_depths.at(x, y);
  };
  for (int begin = 0, end = 0; begin < width_; begin = end + 1) {
    end = begin;
    while (end < width_ && row.is_hidden[static_cast<std::size_t>(end)]) ++end;
    if (end == begin || end - begin == width_) continue;
    const Rgb8 behind = registered.at(nearness(begin - 1) < nearness(end) ? begin - 1 : end, y);
    for (int x = begin; x < end; ++x) registered.at(x, y) = behind;
  }
}

ColorImage ColorRegistration::apply(const ColorImage& color,
                                    const DepthImage& straight_depth) const {
  const InverseDepths inverse_depths =
      filled_inverse_depths(straight_depth, metres_per_depth_unit_);
  const auto side = static_cast<std::size_t>(width_);
  Row row{Eigen::ArrayXf(width_), Eigen::ArrayXf(width_), Eigen::ArrayXf(width_ + 2 * margin_px_),
          Eigen::ArrayXf(width_), std::vector<std::uint8_t>(side)};
  ColorImage registered(width_, height_);
  for (int y = 0; y < height_; ++y) {
    find_places(inverse_depths, y, row);
    find_hidden(inverse_depths, straight_depth, y, row);
    for (int x = 0; x < width_; ++x) registered.at(x, y) = color_between(color, row.u[x], row.v[x]);
    uncover(inverse_depths, y, row, registered);
  }
  return registered;
}

}  // namespace hermite::frame
