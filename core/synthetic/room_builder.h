// Combines shapes and materials to the furniture of the synthetic scenes. Metres, z up, degrees
// about z.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/synthetic/room_furniture.h"

namespace hermite::synthetic {

// Bodies extend this far into what carries them, so that no hidden face is near a visible surface.
inline constexpr double kSunk_m = 0.05;

struct Span {
  double low, high;
};

// Every material that it makes has a seed of its own, so that even equal colours have different
// textures.
class Furnisher {
 public:
  int material(Pattern pattern, std::uint32_t first, std::uint32_t second, float glow = 0);
  Shape& box(Span x, Span y, Span z, int material);
  Shape& sphere(const Eigen::Vector3d& center, double radius, int material);
  // An upright cylinder between two heights.
  Shape& column(double x, double y, Span z, double radius, int material);
  // A cylinder from one point to another.
  Shape& rod(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, int material);
  Shape& torus(const Eigen::Vector3d& center, double ring_radius, double tube_radius, int material);
  Shape& add(ShapeKind kind, const Eigen::Vector3d& size, const Eigen::Vector3d& center,
             int material);

  std::size_t count() const { return out.shapes.size(); }
  // Names the shapes from `first` on. The second object of a name is "NAME2" and so on.
  void name(const std::string& name, std::size_t first);

  Furniture out;
};

// Rotates about the shape's own centre.
void turn(Shape& shape, double angle_deg, const Eigen::Vector3d& axis);

// Rotates the shapes from `first` on about an upright axis through (x, y).
void turn_group(Furniture& furniture, std::size_t first, double angle_deg, double x, double y);

// Target of a group: rotated by quarter turns about an upright axis, so that `from` is moved to
// `to`. Quarter turns are exact, so copies do not differ by rounding.
struct Place {
  Eigen::Vector2d from, to;
  int quarter_turns = 0;  // counter-clockwise seen from above
};

// Moves the shapes [first, last).
void move_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place);

// Appends a copy of the shapes [first, last), with the same materials, at a place.
void copy_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place);

}  // namespace hermite::synthetic
