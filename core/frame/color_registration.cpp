#include "core/frame/color_registration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/frame/color_between.h"

namespace hermite {

namespace {

using InverseDepths = Image<float>;  // 1/m

// Farther than everything: a block that has any depth never keeps it.
constexpr float kUnknown = std::numeric_limits<float>::infinity();
// Below this inverse depth in the colour camera (or behind it) a point has no place in its image: 1 km, or a lens bent backwards.
constexpr float kLeastForward = 1e-3f;

const ColorCamera& color_of(const Camera& camera) {
  CHECK(camera.color.has_value(), "colour that is registered already");
  return *camera.color;
}

Eigen::Matrix3f ray_from_pixel(const Camera& camera) {
  Eigen::Matrix3d pixel_from_ray;
  pixel_from_ray << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d rotation = color_of(camera).color_from_depth.rotation.normalized().toRotationMatrix();
  return (rotation * pixel_from_ray.inverse()).cast<float>();
}

// Half as many rows and columns, rounded up; of four the farthest that is known.
InverseDepths halved(const InverseDepths& fine) {
  InverseDepths coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      const int left = 2 * x, top = 2 * y, right = std::min(left + 1, fine.width - 1), bottom = std::min(top + 1, fine.height - 1);
      coarse.at(x, y) =
          std::min(std::min(fine.at(left, top), fine.at(right, top)), std::min(fine.at(left, bottom), fine.at(right, bottom)));
    }
  return coarse;
}

// Known everywhere; 0, infinitely far, where the whole image knows nothing.
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

}  // namespace

ColorRegistration::ColorRegistration(const Camera& camera)
    : width_(camera.width),
      height_(camera.height),
      metres_per_depth_unit_(static_cast<float>(1 / camera.depth_units_per_metre)),
      color_(color_of(camera)),
      color_is_distorted_(color_.distortion != Distortion{}),
      ray_from_pixel_(ray_from_pixel(camera)),
      depth_camera_m_(color_.color_from_depth.translation.cast<float>()) {
  // Two pixels of the depth image, so that no cell of a surface stays empty.
  cell_px_ = std::max(1, static_cast<int>(std::ceil(2 * std::max(color_.fx / camera.fx, color_.fy / camera.fy))));
  // What hides a point lies in its cell and comes from another pixel of the depth image, so their parallax differs by more than a cell and
  // that pixel. Lenses sit side by side: how much one stands forward shifts nothing. None at all hides nothing.
  const double parallax_px_m = std::max(color_.fx, color_.fy) * color_.color_from_depth.translation.head<2>().norm();
  hiding_per_m_ = static_cast<float>((1.5 * cell_px_) / parallax_px_m);
}

ColorRegistration::Place ColorRegistration::place_of(const Eigen::Vector3f& ray, float inverse_depth_per_m) const {
  const Eigen::Vector3f in_color = ray + inverse_depth_per_m * depth_camera_m_;
  if (!(in_color.z() > kLeastForward)) return {-2, -2, inverse_depth_per_m};
  const float scale = 1 / in_color.z();
  double x = in_color.x() * scale, y = in_color.y() * scale;
  if (color_is_distorted_) {
    const Eigen::Vector2d at = color_.distortion.apply(x, y);
    x = at.x(), y = at.y();
  }
  // Far outside is outside: casts to int stay in range.
  const auto pixel = [](double value, int side) { return static_cast<float>(std::clamp(value, -2.0, side + 1.0)); };
  return {pixel(x * color_.fx + color_.cx, width_), pixel(y * color_.fy + color_.cy, height_), inverse_depth_per_m};
}

std::vector<ColorRegistration::Place> ColorRegistration::places_of(const DepthImage& depth) const {
  InverseDepths inverse_depths(width_, height_);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    inverse_depths.pixels[i] = depth.pixels[i] == 0 ? kUnknown : 1 / (static_cast<float>(depth.pixels[i]) * metres_per_depth_unit_);
  fill(inverse_depths);
  std::vector<Place> places;
  places.reserve(depth.pixels.size());
  for (int y = 0; y < height_; ++y) {
    const Eigen::Vector3f row = ray_from_pixel_.col(1) * static_cast<float>(y) + ray_from_pixel_.col(2);
    for (int x = 0; x < width_; ++x)
      places.push_back(place_of(row + ray_from_pixel_.col(0) * static_cast<float>(x), inverse_depths.at(x, y)));
  }
  return places;
}

// Only what was measured hides.
std::vector<bool> ColorRegistration::hidden(const std::vector<Place>& places, const DepthImage& depth) const {
  InverseDepths nearest((width_ + cell_px_ - 1) / cell_px_, (height_ + cell_px_ - 1) / cell_px_);
  const auto cell = [&](const Place& place) -> float* {
    const int x = static_cast<int>(place.x + 0.5f), y = static_cast<int>(place.y + 0.5f);
    const bool inside = place.x >= 0 && place.y >= 0 && x < width_ && y < height_;
    return inside ? &nearest.at(x / cell_px_, y / cell_px_) : nullptr;
  };
  for (std::size_t i = 0; i < places.size(); ++i)
    if (depth.pixels[i] != 0)
      if (float* value = cell(places[i])) *value = std::max(*value, places[i].inverse_depth_per_m);
  std::vector<bool> hidden(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    if (const float* value = cell(places[i])) hidden[i] = *value - places[i].inverse_depth_per_m > hiding_per_m_;
  return hidden;
}

ColorImage ColorRegistration::apply(const ColorImage& color, const DepthImage& straight_depth) const {
  const std::vector<Place> places = places_of(straight_depth);
  const std::vector<bool> is_hidden = hidden(places, straight_depth);
  ColorImage registered(width_, height_);
  for (std::size_t i = 0; i < places.size(); ++i) registered.pixels[i] = color_between(color, places[i].x, places[i].y);
  for (int y = 0; y < height_; ++y)
    for (int begin = 0, end = 0; begin < width_; begin = end + 1) {
      for (end = begin; end < width_ && is_hidden[registered.index(end, y)];) ++end;
      if (end == begin || (begin == 0 && end == width_)) continue;
      const auto nearness = [&](int x) { return x < 0 || x == width_ ? kUnknown : places[registered.index(x, y)].inverse_depth_per_m; };
      const Rgb8 behind = registered.at(nearness(begin - 1) < nearness(end) ? begin - 1 : end, y);
      for (int x = begin; x < end; ++x) registered.at(x, y) = behind;
    }
  return registered;
}

}  // namespace hermite
