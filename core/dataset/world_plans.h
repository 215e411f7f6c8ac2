// The plans of the synthetic scenes beside the furnished room, see RoomScene. Each adds its shell, walls, furniture and lights to an empty
// furnisher. World frame: metres, z up, the floor at z = 0, the middle of the plan at x = y = 0.
#pragma once

#include "core/dataset/room_builder.h"

namespace hermite {

void furnish_loop(Furnisher& f);
void furnish_twins(Furnisher& f);
void furnish_office(Furnisher& f);
void furnish_blank(Furnisher& f);
void furnish_turntable(Furnisher& f);  // the table's top at z = 0.75, the things on its plate up to 1.1; walls at x = +-2, y = -1.6 and 1

}  // namespace hermite
