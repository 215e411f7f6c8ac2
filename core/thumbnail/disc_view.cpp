#include "core/thumbnail/disc_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/check.h"

namespace hermite::thumbnail {

namespace {

constexpr float kFlattest = 0.05f;    // cosine to the line of sight of discs that are still drawn
constexpr float kMostRadius_px = 64;  // a bound for the time that one point may take
// Colours are scanned with the light of the room: a little shading shows the form.
constexpr float kAmbient = 0.72f;

struct Canvas {
  DiscImage image;
  std::vector<float> depth_m;
};

struct Disc {
  Eigen::Vector3f centre_m, normal;  // in the frame of the view
  float radius_m = 0;
  Rgb8 color;
};

Rgb8 shaded(Rgb8 color, const Eigen::Vector3f& normal) {
  // Over the left shoulder.
  const Eigen::Vector3f light = Eigen::Vector3f(-0.4f, -0.5f, -0.77f).normalized();
  const float shade = kAmbient + (1 - kAmbient) * std::max(0.0f, normal.dot(light));
  const auto part = [shade](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(static_cast<float>(value) * shade));
  };
  return {part(color.r), part(color.g), part(color.b)};
}

void put(Canvas& canvas, int x, int y, float depth_m, Rgb8 color) {
  const std::size_t pixel = canvas.image.color.index(x, y);
  if (!(depth_m < canvas.depth_m[pixel])) return;
  if (canvas.depth_m[pixel] == std::numeric_limits<float>::infinity()) ++canvas.image.drawn_px;
  canvas.depth_m[pixel] = depth_m;
  canvas.image.color.pixels[pixel] = color;
}

void draw(Canvas& canvas, const Disc& disc, const ParallelView& view) {
  const int width = canvas.image.color.width, height = canvas.image.color.height;
  const Eigen::Vector2f half(static_cast<float>(width - 1) / 2, static_cast<float>(height - 1) / 2);
  const Eigen::Vector2f centre_px =
      (disc.centre_m.head<2>() - view.middle_m) * view.pixels_per_m + half;
  const float reach_px = std::min(disc.radius_m * view.pixels_per_m, kMostRadius_px);
  const Eigen::Vector2f size(static_cast<float>(width), static_cast<float>(height));
  if (!((centre_px.array() > -reach_px - 1).all() &&
        (centre_px.array() < size.array() + reach_px).all()))
    return;
  const Rgb8 color = shaded(disc.color, disc.normal);
  const auto first = [](float at, float reach) {
    return std::max(0, static_cast<int>(std::ceil(at - reach)));
  };
  const auto last = [](float at, float reach, int end) {
    return std::min(end - 1, static_cast<int>(std::floor(at + reach)));
  };
  const int nearest_x = static_cast<int>(std::lround(centre_px.x())),
            nearest_y = static_cast<int>(std::lround(centre_px.y()));
  if (nearest_x >= 0 && nearest_x < width && nearest_y >= 0 && nearest_y < height)
    put(canvas, nearest_x, nearest_y, disc.centre_m.z(), color);
  const float radius2_m2 = disc.radius_m * disc.radius_m;
  for (int y = first(centre_px.y(), reach_px); y <= last(centre_px.y(), reach_px, height); ++y)
    for (int x = first(centre_px.x(), reach_px); x <= last(centre_px.x(), reach_px, width); ++x) {
      const float dx_m = (static_cast<float>(x) - centre_px.x()) / view.pixels_per_m;
      const float dy_m = (static_cast<float>(y) - centre_px.y()) / view.pixels_per_m;
      const float dz_m = -(disc.normal.x() * dx_m + disc.normal.y() * dy_m) / disc.normal.z();
      const float distance2_m2 = dx_m * dx_m + dy_m * dy_m + dz_m * dz_m;
      // Bent away towards its edge: of discs that overlap, the one with the nearest centre is seen
      // (paraboloids, Schuetz 2016).
      if (distance2_m2 <= radius2_m2)
        put(canvas, x, y, disc.centre_m.z() + dz_m + distance2_m2 / disc.radius_m, color);
    }
}

}  // namespace

DiscImage draw_discs(const output::Cloud& cloud, const ParallelView& view, int width_px,
                     int height_px, Rgb8 background) {
  CHECK(width_px > 0 && height_px > 0, "an image has pixels");
  Canvas canvas{{ColorImage(width_px, height_px), 0}, {}};
  std::fill(canvas.image.color.pixels.begin(), canvas.image.color.pixels.end(), background);
  canvas.depth_m.assign(canvas.image.color.pixels.size(), std::numeric_limits<float>::infinity());
  for (const output::CloudPoint& point : cloud) {
    if (!point.position_m.allFinite()) continue;
    Eigen::Vector3f normal = view.view_from_world * point.normal;
    if (!(normal.squaredNorm() > 0.5f)) normal = {0, 0, -1};
    if (normal.z() > -kFlattest) continue;
    draw(canvas,
         {view.view_from_world * point.position_m, normal,
          view.radius_scale * std::max(0.0f, point.radius_m), point.color},
         view);
  }
  return std::move(canvas.image);
}

}  // namespace hermite::thumbnail
