// The pieces of the furnished room, each at its position there: walls at x = +-kRoomLength_m / 2
// and y = +-kRoomWidth_m / 2. Other scenes use a piece by moving its group. Bodies extend by
// kSunk_m into what carries them.
#pragma once

#include "core/synthetic/room_builder.h"

namespace hermite::synthetic {

void add_trim(Furnisher& f);  // skirting boards, beams, rug
// Back to the wall at y = +1.9, middle x = -1.5, 1.2 wide, 0.28 deep.
void add_bookshelf(Furnisher& f);
// Back to the wall at y = +1.9, middle x = 0.15, 1.48 wide, 0.47 deep, a painting above.
void add_sideboard(Furnisher& f);
void add_floor_lamp(Furnisher& f);  // at (1.35, 1.45)
// Back to the wall at x = +2.4, middle y = -0.1, 2.0 wide, 0.86 deep.
void add_sofa(Furnisher& f);
void add_window(Furnisher& f);  // on the wall at x = +2.4, middle y = -0.1, with curtains
// Back to the wall at y = -1.9, middle x = -0.5, 1.5 wide, 0.64 deep, paintings above.
void add_desk(Furnisher& f);
// A chair whose seat is above (x, y): legs and back posts are rods of 2 cm, the stretchers of 1 cm,
// the back a panel of 1 cm. It faces +y if the angle is 0.
void add_chair(Furnisher& f, double x, double y, double angle_deg);
void add_door(Furnisher& f);          // closed, on the wall at y = -1.9, middle x = 1.41, 1.02 wide
void add_plant(Furnisher& f);         // at (-2.0, 0.95)
void add_west_wall(Furnisher& f);     // a painting, a low cabinet with ceramics and a pillar
void add_divider(Furnisher& f);       // a free-standing screen of two panels, 1 cm thin
void add_coffee_table(Furnisher& f);  // at the origin, 0.42 in radius
void add_toys(Furnisher& f);

}  // namespace hermite::synthetic
