#include "core/texture/texture_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/texture/view_raster.h"

namespace hermite::texture {

namespace {

using Eigen::Vector3f;

// Tolerance for the mesh's depth: its triangles are chords of the surface, and texels beside a
// chart lie off it.
constexpr float kHiddenShare = 0.01f, kHidden_m = 0.004f;
// At more than 80 degrees a pixel is smeared over five or more texels.
constexpr float kLeastCosine = 0.17f;
// Distance from an edge of the mesh's depth at which the colour is certainly that of this surface.
constexpr float kSurelyInside_px = 10;

// Weights of four samples for a position between the middle two (Keys, Cubic Convolution
// Interpolation for Digital Image Processing, IEEE Transactions on Acoustics, Speech, and Signal
// Processing 1981). Linear interpolation would blur strokes that are one pixel wide.
std::array<float, 4> cubic_weights(float t) {
  return {t * (-0.5f + t * (1 - 0.5f * t)), 1 + t * t * (-2.5f + 1.5f * t),
          t * (0.5f + t * (2 - 1.5f * t)), t * t * (-0.5f + 0.5f * t)};
}

}  // namespace

float linear_from_srgb_byte(float value) {
  const float v = value / 255;
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

float srgb_byte_from_linear(float linear) {
  return 255 *
         (linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f);
}

ViewWarp::ViewWarp(int width, int height)
    : columns((width - 2) / kStep_px + 2),
      rows((height - 2) / kStep_px + 2),
      nodes_px(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
               Eigen::Vector2f::Zero()) {}

std::array<WarpNode, 4> ViewWarp::around(float u, float v) const {
  const float column = u / kStep_px, row = v / kStep_px;
  const int x = std::clamp(static_cast<int>(column), 0, columns - 2),
            y = std::clamp(static_cast<int>(row), 0, rows - 2);
  const float dx = column - static_cast<float>(x), dy = row - static_cast<float>(y);
  return {{{node(x, y), (1 - dx) * (1 - dy)},
           {node(x + 1, y), dx * (1 - dy)},
           {node(x, y + 1), (1 - dx) * dy},
           {node(x + 1, y + 1), dx * dy}}};
}

Eigen::Vector2f ViewWarp::at(float u, float v) const {
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();
  if (nodes_px.empty()) return offset;
  for (const WarpNode& near : around(u, v)) offset += near.weight * nodes_px[near.index];
  return offset;
}

void set_pose(TextureView& view, const Rigid3& world_from_camera) {
  const Rigid3 camera_from_world = inverse(world_from_camera);
  view.world_from_camera = world_from_camera;
  view.rotation = camera_from_world.rotation.toRotationMatrix().cast<float>();
  view.translation_m = camera_from_world.translation.cast<float>();
  view.place_m = world_from_camera.translation.cast<float>();
}

void set_gain(TextureView& view, const Vector3f& gain) {
  view.gain = gain;
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t value = 0; value < 256; ++value)
      view.corrected[channel][value] =
          srgb_byte_from_linear(linear_from_srgb_byte(static_cast<float>(value)) /
                                gain[static_cast<Eigen::Index>(channel)]);
}

void see_mesh(TextureView& view, const output::TriangleMesh& mesh, const TextureFrames& frames) {
  view.inverse_depth_per_m =
      rasterised(mesh, frames.camera, view.world_from_camera).inverse_depth_per_m;
  if (frames.is_seen.pixels.empty()) {
    view.distance_from_edge_px = distance_from_edges_px(view.inverse_depth_per_m);
    return;
  }
  // The border of the lens's image counts as an edge.
  Image<float> masked = view.inverse_depth_per_m;
  for (std::size_t i = 0; i < masked.pixels.size(); ++i)
    if (frames.is_seen.pixels[i] == 0) masked.pixels[i] = 0;
  view.distance_from_edge_px = distance_from_edges_px(masked);
}

Result<TextureView> load_view(const output::TriangleMesh& mesh, const TextureFrames& frames,
                              std::size_t frame) {
  Result<ColorImage> color = frames.read(frame);
  if (!color.ok()) return color.error();
  const Camera& camera = frames.camera;
  if (color->width != camera.width || color->height != camera.height)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("frame {} is {}x{}, the camera's images are {}x{}", frame,
                             color->width, color->height, camera.width, camera.height)};
  TextureView view;
  view.frame = frame;
  view.color = *std::move(color);
  set_pose(view, *frames.world_from_camera[frame]);
  set_gain(view, Vector3f::Ones());
  see_mesh(view, mesh, frames);
  return view;
}

std::optional<Seen> seen_at(const TextureView& view, const Camera& camera,
                            const Vector3f& position_m, const Vector3f& normal,
                            float least_edge_px) {
  const Vector3f point = view.rotation * position_m + view.translation_m;
  if (!(point.z() > static_cast<float>(kNearestDrawn_m))) return std::nullopt;
  Seen seen;
  seen.depth_m = point.z();
  seen.u = static_cast<float>(camera.fx) * point.x() / point.z() + static_cast<float>(camera.cx);
  seen.v = static_cast<float>(camera.fy) * point.y() / point.z() + static_cast<float>(camera.cy);
  if (!(seen.u >= 0 && seen.v >= 0 && seen.u < static_cast<float>(camera.width - 1) &&
        seen.v < static_cast<float>(camera.height - 1)))
    return std::nullopt;
  const Vector3f way = view.place_m - position_m;
  seen.cosine = normal.dot(way) / way.norm();
  if (seen.cosine < kLeastCosine) return std::nullopt;
  const int x = static_cast<int>(seen.u), y = static_cast<int>(seen.v);
  const float dx = seen.u - static_cast<float>(x), dy = seen.v - static_cast<float>(y);
  const auto between = [&](const auto& image) {
    const auto value = [&](int column, int row) {
      return static_cast<float>(image.at(column, row));
    };
    return (1 - dy) * ((1 - dx) * value(x, y) + dx * value(x + 1, y)) +
           dy * ((1 - dx) * value(x, y + 1) + dx * value(x + 1, y + 1));
  };
  seen.edge_px = between(view.distance_from_edge_px);
  if (seen.edge_px < least_edge_px) return std::nullopt;
  const float mesh_inverse_depth = between(view.inverse_depth_per_m);
  if (!(mesh_inverse_depth * (seen.depth_m - kHidden_m) < 1 + kHiddenShare)) return std::nullopt;
  return seen;
}

Vector3f color_at(const TextureView& view, float straight_u, float straight_v) {
  const Eigen::Vector2f offset = view.warp.at(straight_u, straight_v);
  const float u =
      std::clamp(straight_u + offset.x(), 0.0f, static_cast<float>(view.color.width - 1));
  const float v =
      std::clamp(straight_v + offset.y(), 0.0f, static_cast<float>(view.color.height - 1));
  const int x = std::min(static_cast<int>(u), view.color.width - 2),
            y = std::min(static_cast<int>(v), view.color.height - 2);
  const std::array<float, 4> across = cubic_weights(u - static_cast<float>(x)),
                             down = cubic_weights(v - static_cast<float>(y));
  Vector3f sum = Vector3f::Zero();
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y - 1 + j, 0, view.color.height - 1);
    Vector3f row_sum = Vector3f::Zero();
    for (int i = 0; i < 4; ++i) {
      const Rgb8& pixel = view.color.at(std::clamp(x - 1 + i, 0, view.color.width - 1), row);
      row_sum += across[static_cast<std::size_t>(i)] * Vector3f(view.corrected[0][pixel.r],
                                                                view.corrected[1][pixel.g],
                                                                view.corrected[2][pixel.b]);
    }
    sum += down[static_cast<std::size_t>(j)] * row_sum;
  }
  return sum;
}

float quality_of(const TextureView& view, const Camera& camera, const Seen& seen, float texel_m) {
  const float pixels_per_texel = static_cast<float>(camera.fx) * texel_m / seen.depth_m;
  // More than one pixel per texel adds little.
  const float resolution =
      pixels_per_texel * pixels_per_texel / (0.5f + pixels_per_texel * pixels_per_texel);
  const float inside = std::clamp(seen.edge_px / kSurelyInside_px, 0.0f, 1.0f);
  const float sharpness = 1 / (1 + 0.25f * view.blur_px * view.blur_px);
  const float slant = seen.cosine - kLeastCosine;
  return 1.5f * resolution * slant * slant * inside * sharpness;
}

}  // namespace hermite::texture
