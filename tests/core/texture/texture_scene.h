// A wall with a checker and a camera that looks at it, by formulas: views of which the truth is
// known. Header only.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"
#include "core/texture/texture_options.h"
#include "core/texture/texture_view.h"

namespace hermite::test {

inline constexpr float kWall_m = 2;  // its distance from the origin along z, and its side

inline Camera small_camera() { return Camera{160, 120, 130, 130, 79.5, 59.5}; }

// The wall's colour 0 to 255 at a place: a soft checker of 12 cm, other frequencies in the other
// channels.
inline Eigen::Vector3f wall_color(double x_m, double y_m) {
  const double a = std::sin(x_m * 26) * std::sin(y_m * 26),
               b = std::sin(x_m * 17 + 1) * std::cos(y_m * 13);
  return Eigen::Vector3d(120 + 60 * a, 120 + 50 * b,
                         120 + 40 * a * b + 20 * std::sin(31 * x_m + 9 * y_m))
      .cast<float>();
}

inline Rgb8 byte_color(const Eigen::Vector3f& color) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::fmin(std::fmax(value + 0.5f, 0.0f), 255.0f));
  };
  return {byte(color.x()), byte(color.y()), byte(color.z())};
}

// A grid of `cells` x `cells` squares around (x, y) at depth z that looks towards the origin, grey.
inline void add_wall(output::TriangleMesh& mesh, std::uint32_t cells, float side_m, float x_m,
                     float y_m, float z_m) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const auto at = [&](std::uint32_t k) {
        return side_m * (static_cast<float>(k) / static_cast<float>(cells) - 0.5f);
      };
      mesh.positions_m.push_back({x_m + at(i), y_m + at(j), z_m});
      mesh.normals.push_back({0, 0, -1});
      mesh.colors.push_back({120, 120, 120});
    }
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = first + j * (cells + 1) + i, b = a + 1, c = b + cells + 1,
                          d = a + cells + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({a, d, c});
    }
}

inline output::TriangleMesh wall_mesh(std::uint32_t cells = 16) {
  output::TriangleMesh mesh;
  add_wall(mesh, cells, kWall_m, 0, 0, kWall_m);
  return mesh;
}

// What a camera there sees of the infinite wall, each linear light times the gain.
inline ColorImage wall_image(const Camera& camera, const Rigid3& world_from_camera,
                             double gain = 1) {
  ColorImage image(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = world_from_camera.rotation * camera.unproject(x, y, 1);
      const Eigen::Vector3d at = world_from_camera.translation +
                                 (kWall_m - world_from_camera.translation.z()) / ray.z() * ray;
      Eigen::Vector3f color = wall_color(at.x(), at.y());
      for (float& value : color)
        value = texture::srgb_byte_from_linear(static_cast<float>(gain) *
                                               texture::linear_from_srgb_byte(value));
      image.at(x, y) = byte_color(color);
    }
  return image;
}

// Cameras 15 cm apart in a grid, `columns` x `rows`, which look straight at the wall from 1.2 m.
inline std::vector<Rigid3> grid_of_poses(int columns, int rows) {
  std::vector<Rigid3> poses;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      poses.push_back({Eigen::Quaterniond::Identity(),
                       {0.15 * (i - 0.5 * (columns - 1)), 0.15 * (j - 0.5 * (rows - 1)), 0.8}});
  return poses;
}

// Frames rendered at `true_poses`; the texture is told `poses`.
inline texture::TextureFrames wall_frames(const std::vector<Rigid3>& true_poses,
                                          const std::vector<Rigid3>& poses,
                                          std::vector<double> gains = {}) {
  texture::TextureFrames frames;
  frames.camera = small_camera();
  for (const Rigid3& pose : poses) frames.world_from_camera.emplace_back(pose);
  frames.read = [true_poses, gains](std::size_t i) -> Result<ColorImage> {
    return wall_image(small_camera(), true_poses[i], gains.empty() ? 1 : gains[i]);
  };
  return frames;
}

}  // namespace hermite::test
