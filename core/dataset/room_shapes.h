// The bodies of the synthetic room: exact ray intersection and exact signed distance. Plain values, pure functions, double precision.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace hermite {

enum class ShapeKind : std::uint8_t {
  kRoom,      // the inside of a box: solid all around it
  kBox,       //
  kSphere,    //
  kCylinder,  // axis z, with flat ends
  kTorus,     // around z
};

struct Shape {
  ShapeKind kind = ShapeKind::kBox;
  // kRoom and kBox: half side lengths. kSphere: (radius, 0, 0). kCylinder: (radius, half height, 0). kTorus: (ring radius, tube radius, 0).
  // Metres.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  Eigen::Matrix3d world_from_shape = Eigen::Matrix3d::Identity();  // a rotation
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // in the world [m]
  int material = 0;
};

// Half side lengths of the box around the shape, along the shape's own axes.
Eigen::Vector3d bounding_half_sides(const Shape& shape);

// Of a point in the shape's own frame, negative inside the solid; exact on both sides.
double signed_distance(const Shape& shape, const Eigen::Vector3d& point_in_shape);

// Smallest t > t_min at which origin + t * direction (any length, in the shape's frame) enters the solid; infinity when it does not.
// The origin must be outside the solid. Tori are found to 1e-7 m, the others to rounding.
double intersect(const Shape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min);

// What a texture and the light need to know of a point on the surface.
struct SurfacePoint {
  Eigen::Vector3d normal;       // unit, out of the solid, in the shape's frame
  Eigen::Vector2d position_m;   // along the surface
  Eigen::Vector2d half_size_m;  // of the face, around position 0; zero for a torus
  int face = 0;                 // 0 to 5
};
SurfacePoint describe(const Shape& shape, const Eigen::Vector3d& point_in_shape);

// The face alone, cheaper.
int face_of(const Shape& shape, const Eigen::Vector3d& point_in_shape);

}  // namespace hermite
