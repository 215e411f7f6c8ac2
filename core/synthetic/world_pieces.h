// Furniture of the larger scenes. Each piece is made for a north wall, with the middle of its back
// at the origin and its front towards -y; move_group moves it to its place. Bodies extend by
// kSunk_m into what carries them.
#pragma once

#include "core/synthetic/room_builder.h"

namespace hermite::synthetic {

void add_bed(Furnisher& f);       // 1.0 wide, 2.05 deep, head at the wall
void add_wardrobe(Furnisher& f);  // 1.2 wide, 0.60 deep, 2.0 high
void add_dresser(Furnisher& f);   // 1.15 wide, 0.45 deep, ceramics on it
void add_radiator(Furnisher& f);  // 0.92 wide, 0.12 deep
void add_coats(Furnisher& f);     // a rail with coats, 1.0 wide, 0.2 deep
// A desk with screen, things and a chair: 1.6 wide, 0.73 deep, the chair to 1.1.
void add_workplace(Furnisher& f, int cloth, int screen);
// A rack of an office, with binders: 1.32 wide, 0.32 deep, 1.7 high.
void add_rack(Furnisher& f);
// A wall lamp, 0.2 wide, 0.12 deep, at 1.7.
void add_sconce(Furnisher& f);

}  // namespace hermite::synthetic
