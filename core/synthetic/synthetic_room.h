// Furnished rooms defined by formulas: walls, tables, chairs with thin legs, shelves with books,
// spheres, cylinders, tori, thin panels. Their images, depth and the distance to their surface are
// exact. World frame: metres, z up, floor at z = 0, centre of the plan at x = y = 0.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::synthetic {

struct RoomChange;

enum class RoomScene {
  kRoom,  // furnished, 4.8 x 3.8 m
  kBare,  // only its floor, ceiling and walls
  // Two different rooms side by side, a door between them, a corridor along both: a circuit.
  kLoop,
  // The same room at both ends of a corridor, the second turned by 180 degrees: no circuit.
  kTwins,
  // A long room with a row of equal workplaces between rows of equal racks: a circuit around the
  // row.
  kOffice,
  kBlank,      // a corridor around a block, with plain walls and little on them
  kTurntable,  // a plate with objects on it, which turns about z, on a table in front of a wall
  kPoster,     // a wall with text on it, a metre away
};

struct RoomView {
  // z along the optical axis in the camera's units, rounded; 0 outside 0.05 m to the largest value
  // of 16 bits.
  DepthImage depth;
  ColorImage color;  // lit by a fixed light, independent of the view direction; anti-aliased
};

// Immutable after construction; const functions are thread-safe. Rendering starts up to 3 helper
// threads and waits for them.
class SyntheticRoom {
 public:
  // kInvalidArgument as for apply_changes (room_changes.h).
  static Result<SyntheticRoom> create(RoomScene scene, const std::vector<RoomChange>& changes);
  explicit SyntheticRoom(RoomScene scene);
  ~SyntheticRoom();
  SyntheticRoom(SyntheticRoom&&) noexcept;

  // Casts rays through the pixel centres; depth is exact to rounding. The camera must be inside the
  // room and outside the furniture. Turning objects (kTurntable) are rotated by this angle,
  // counter-clockwise seen from above, and are lit in that position.
  RoomView render(const Camera& camera, const Rigid3& world_from_camera,
                  double turned_rad = 0) const;

  // Returns the unsigned distance [m] to the nearest surface. It is exact for points in free space
  // and for points inside one body; bodies extend into each other, so hidden faces (the back of a
  // shelf in the wall) do not count as surface. Turning objects are in their initial position.
  double surface_distance(const Eigen::Vector3d& point_in_world) const;

 private:
  struct Contents;
  explicit SyntheticRoom(std::unique_ptr<const Contents> contents);
  std::unique_ptr<const Contents> contents_;
};

}  // namespace hermite::synthetic
