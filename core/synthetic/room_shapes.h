// The bodies of the synthetic room: exact ray intersection and exact signed distance. Plain values,
// pure functions, double precision.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace hermite::synthetic {

enum class ShapeKind : std::uint8_t {
  kRoom,      // the inside of a box; everything around it is solid
  kBox,       //
  kSphere,    //
  kCylinder,  // axis z, with flat ends
  kTorus,     // around z
};

struct Shape {
  ShapeKind kind = ShapeKind::kBox;
  // kRoom and kBox: half side lengths. kSphere: (radius, 0, 0). kCylinder: (radius, half height,
  // 0). kTorus: (ring radius, tube radius, 0). Metres.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  Eigen::Matrix3d world_from_shape = Eigen::Matrix3d::Identity();  // a rotation
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // in the world [m]
  int material = 0;
};

// Returns half the side lengths of the bounding box along the shape's own axes.
Eigen::Vector3d bounding_half_sides(const Shape& shape);

// Returns the distance of a point in the shape's coordinate frame, negative inside the solid; exact
// on both sides.
double signed_distance(const Shape& shape, const Eigen::Vector3d& point_in_shape);

// Returns the smallest t > t_min at which origin + t * direction (any length, in the shape's
// coordinate frame) enters the solid; infinity if it does not. The origin must be outside the
// solid. Tori are found to 1e-7 m, other shapes to rounding.
double intersect(const Shape& shape, const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& direction, double t_min);

// Properties of a surface point that textures and light need.
struct SurfacePoint {
  Eigen::Vector3d normal;       // unit, out of the solid, in the shape's coordinate frame
  Eigen::Vector2d position_m;   // along the surface
  Eigen::Vector2d half_size_m;  // of the face, around position 0; zero for a torus
  int face = 0;                 // 0 to 5
};
SurfacePoint describe(const Shape& shape, const Eigen::Vector3d& point_in_shape);

// Returns only the face, which is cheaper.
int face_of(const Shape& shape, const Eigen::Vector3d& point_in_shape);

}  // namespace hermite::synthetic
