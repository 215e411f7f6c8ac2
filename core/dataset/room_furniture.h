// What stands where in the synthetic room: every body with its place, size and material.
#pragma once

#include <vector>

#include "core/dataset/room_shapes.h"
#include "core/dataset/room_textures.h"
#include "core/dataset/synthetic_room.h"

namespace hermite {

inline constexpr double kRoomLength_m = 4.8;  // x
inline constexpr double kRoomWidth_m = 3.8;   // y
inline constexpr double kRoomHeight_m = 2.6;  // z

struct Furniture {
  std::vector<Shape> shapes;  // the first is the room itself
  std::vector<Material> materials;
};

// Always the same for the same scene.
Furniture furnish(RoomScene scene);

// The room's six faces carry different materials: floor, ceiling and four walls. Index of the face's material.
int room_material_of_face(int face);

}  // namespace hermite
