// The contents of a synthetic scene: every body with its position, size and material, and the
// lights.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/synthetic/room_shapes.h"
#include "core/synthetic/room_textures.h"
#include "core/synthetic/synthetic_room.h"

namespace hermite::synthetic {

inline constexpr double kRoomLength_m = 4.8;  // x
inline constexpr double kRoomWidth_m = 3.8;   // y
inline constexpr double kRoomHeight_m = 2.6;  // z; for every scene
inline constexpr double kHalfLength_m = kRoomLength_m / 2, kHalfWidth_m = kRoomWidth_m / 2;

// A lamp, which is a tube between two points, and a window, which light only the surroundings of
// the zone's rectangle: light does not pass through walls.
struct LightZone {
  Eigen::Vector2f low_m, high_m;
  Eigen::Vector3f lamp_from_m, lamp_to_m, window_m;
};

// Shapes [first, last) that belong together, such as "sofa". An object may lie within another one.
struct NamedObject {
  std::string name;
  std::size_t first, last;
};

struct Furniture {
  // The first, of kind kRoom, encloses everything and is solid all around.
  std::vector<Shape> shapes;
  std::vector<Material> materials;
  std::vector<LightZone> lights;     // at least one
  std::vector<NamedObject> objects;  // that room_changes.h can move and remove; names are unique
  std::size_t turning_count = 0;     // the last ones, this many, turn about the world's z axis
};

// Returns the same furniture each time for the same scene.
Furniture furnish(RoomScene scene);

// The room's six faces have different materials: floor, ceiling and four walls. Returns the index
// of the face's material.
int room_material_of_face(int face);

}  // namespace hermite::synthetic
