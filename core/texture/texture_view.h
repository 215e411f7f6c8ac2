// A view is a frame from which a texture takes colour: its image, the depth of the mesh, and how
// well it sees a point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"

namespace hermite::texture {

// By channel: the corrected value, 0 to 255 or above, for each value of the image.
using ColorTable = std::array<std::array<float, 256>, 3>;

// A lattice of pixel offsets over an image, interpolated bilinearly, which are added to the
// projection by the pose. Without nodes the offset is 0.
struct WarpNode {
  std::size_t index = 0;
  float weight = 0;
};
struct ViewWarp {
  static constexpr int kStep_px = 48;  // between nodes
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector2f> nodes_px;  // offsets, row by row

  ViewWarp() = default;
  ViewWarp(int width, int height);  // size of the image; offsets of 0
  std::size_t node(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(x);
  }
  std::array<WarpNode, 4> around(float u, float v) const;
  Eigen::Vector2f at(float u, float v) const;  // Returns the offset [px].
};

struct TextureView {
  std::size_t frame = 0;
  Rigid3 world_from_camera;
  // camera_from_world, for the loops over all texels.
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f place_m = Eigen::Vector3f::Zero();  // of the camera in the world
  ColorImage color;
  Image<float> inverse_depth_per_m;  // of the mesh
  // view_raster.h; also 0 outside the image of the lens.
  Image<std::uint8_t> distance_from_edge_px;
  float blur_px = 0;  // how far the image moved within one frame
  // By channel: brightness relative to the mean of all views, in linear light.
  Eigen::Vector3f gain = Eigen::Vector3f::Ones();
  ViewWarp warp;
  ColorTable corrected{};  // sRGB of the image to sRGB of the mean exposure
};

void set_pose(TextureView& view, const Rigid3& world_from_camera);
void set_gain(TextureView& view, const Eigen::Vector3f& gain);

// Loads the image and renders the depth of the mesh. Errors are those of reading the frame;
// kCorruptData for an image of another size.
Result<TextureView> load_view(const output::TriangleMesh& mesh, const TextureFrames& frames,
                              std::size_t frame);
// Renders the depth again, at the present pose of the view.
void see_mesh(TextureView& view, const output::TriangleMesh& mesh, const TextureFrames& frames);

// Convert sRGB values, 0 to 255, to linear light and back; larger values are extrapolated.
float linear_from_srgb_byte(float value);
float srgb_byte_from_linear(float linear);

struct Seen {
  float u = 0, v = 0, depth_m = 0;  // pixel
  float cosine = 0;                 // between the normal and the direction to the camera
  float edge_px = 0;                // distance from an edge, interpolated
};
// Returns where the view sees the point; std::nullopt if it is outside the image, faces away, is
// hidden by the mesh, or is nearer than `least_edge_px` to an edge. A point is hidden if it is
// deeper than the mesh by more than a hundredth and a texel or two.
std::optional<Seen> seen_at(const TextureView& view, const Camera& camera,
                            const Eigen::Vector3f& position_m, const Eigen::Vector3f& normal,
                            float least_edge_px);

// Returns the corrected colour there after the warp, by bicubic interpolation, which may overshoot
// a step by up to a tenth.
Eigen::Vector3f color_at(const TextureView& view, float u, float v);

// Returns how well the view sees a texel of this size, 0 to 1: more for more pixels per texel, less
// at a slant, near edges and with motion blur. Varies smoothly from texel to texel.
float quality_of(const TextureView& view, const Camera& camera, const Seen& seen, float texel_m);

}  // namespace hermite::texture
