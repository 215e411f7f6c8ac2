// Puts bodies and materials together: what the furniture of the synthetic scenes is written in. Metres, z up, degrees about z.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/dataset/room_furniture.h"

namespace hermite {

// Bodies reach this far into what carries them, so that no hidden face is near the surface that the camera sees.
inline constexpr double kSunk_m = 0.05;

struct Span {
  double low, high;
};

// Every material it makes differs from those before it in its seed, even where the colours are equal.
class Furnisher {
 public:
  int material(Pattern pattern, std::uint32_t first, std::uint32_t second, float glow = 0);
  Shape& box(Span x, Span y, Span z, int material);
  Shape& sphere(const Eigen::Vector3d& center, double radius, int material);
  // Round, upright, between two heights.
  Shape& column(double x, double y, Span z, double radius, int material);
  // Round, from one point to another.
  Shape& rod(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, int material);
  Shape& torus(const Eigen::Vector3d& center, double ring_radius, double tube_radius, int material);
  Shape& add(ShapeKind kind, const Eigen::Vector3d& size, const Eigen::Vector3d& center, int material);

  std::size_t count() const { return out.shapes.size(); }

  Furniture out;
};

// About the shape's own centre.
void turn(Shape& shape, double angle_deg, const Eigen::Vector3d& axis);

// Turns the shapes from `first` on about an upright axis through (x, y).
void turn_group(Furniture& furniture, std::size_t first, double angle_deg, double x, double y);

// Where a group goes: turned by quarters about an upright axis, so that `from` comes to `to`. Quarters are exact: no rounding between
// copies.
struct Place {
  Eigen::Vector2d from, to;
  int quarter_turns = 0;  // counter-clockwise seen from above
};

// Moves the shapes [first, last).
void move_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place);

// Appends a copy of the shapes [first, last), same materials, at a place.
void copy_group(Furniture& furniture, std::size_t first, std::size_t last, const Place& place);

}  // namespace hermite
