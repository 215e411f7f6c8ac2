// Rooms with doors made of boxes. A plan is a set of rectangular areas with kWall_m between
// neighbours; each area builds its own leaf of the walls around it, so that both sides of a wall
// can look different. Leaves overlap inside the wall; every visible face belongs to one body.
#pragma once

#include <array>
#include <vector>

#include "core/synthetic/room_builder.h"

namespace hermite::synthetic {

inline constexpr double kWall_m = 0.12;  // thickness between two areas
// Clear width of an opening, before the frame takes 3 cm.
inline constexpr double kDoor_m = 0.90;
inline constexpr double kDoorTop_m = 2.05;   // height of an opening, before the frame takes 1.5 cm
inline constexpr double kSkirting_m = 0.09;  // height

// The value is also the number of quarter turns that rotate a piece made for the north wall to this
// one.
enum class Side { kNorth, kWest, kSouth, kEast };  // +y, -x, -y, +x

struct Area {
  Span x, y;  // extent of the free interior
};

// A wall of an area.
struct Wall {
  const Area& area;
  Side side;
};

struct AreaLook {
  std::array<int, 4> walls;  // materials, in the order of Side
  int floor;                 // material
  int trim;                  // of skirting boards and door frames
};

struct Opening {
  Side side;
  double middle;  // x on north and south walls, y on the others
};

struct Paint {
  Pattern pattern;
  std::uint32_t first, second;  // 0xRRGGBB
};

// The first body: the shell around all areas, solid beyond half a wall outside them.
struct ShellLook {
  Paint wall, floor, ceiling;
};
void add_shell(Furnisher& f, const std::vector<Area>& areas, const ShellLook& look);

// Adds walls with openings, door frames, skirting boards and a floor that is 6 mm thick on that of
// the shell. Floors meet in the middle of the openings.
void add_area(Furnisher& f, const Area& area, const AreaLook& look,
              const std::vector<Opening>& openings);

// Adds a lamp under the ceiling along the centre line of the area, and light from a window at the
// middle of one wall.
void light_area(Furnisher& f, const Area& area, Side window);

// The extents of a box at a wall.
struct WallBox {
  Span along;  // the wall, in world coordinates
  Span depth;  // from the wall's face into the area; negative: into the wall
  Span z;
};

// Adds the box and returns its shape.
Shape& on_wall(Furnisher& f, Wall wall, const WallBox& box, int material);

// Returns the point at the foot of a wall, for Place::to.
Eigen::Vector2d at_wall(const Area& area, Side side, double along);

// A painting in a frame, `width` x `height`, with its centre at `along` and height `z`.
struct WallPainting {
  double along, z, width, height;
  int frame, image;  // materials
};
void add_painting(Furnisher& f, const Area& area, Side side, const WallPainting& painting);

}  // namespace hermite::synthetic
