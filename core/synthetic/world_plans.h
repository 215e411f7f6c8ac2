// The plans of the synthetic scenes other than the furnished room, see RoomScene. Each adds its
// shell, walls, furniture and lights to an empty furnisher. World frame: metres, z up, the floor at
// z = 0, the middle of the plan at x = y = 0.
#pragma once

#include "core/synthetic/room_builder.h"

namespace hermite::synthetic {

void furnish_loop(Furnisher& f);
void furnish_twins(Furnisher& f);
void furnish_office(Furnisher& f);
void furnish_blank(Furnisher& f);
// Table top at z = 0.75, objects on its plate up to 1.1; walls at x = +-2, y = -1.6 and 1.
void furnish_turntable(Furnisher& f);
// The centre of the poster's text is at x = 0, y = kPosterWall_m, z = kPosterHeight_m, facing -y.
inline constexpr double kPosterWall_m = 1.0, kPosterHeight_m = 1.45;
void furnish_poster(Furnisher& f);

}  // namespace hermite::synthetic
