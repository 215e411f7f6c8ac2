// The text on the poster of the synthetic scenes: capital letters of straight strokes.
// Deterministic, pure functions.
#pragma once

#include "core/synthetic/room_textures.h"

namespace hermite::synthetic {

// Lines from top to bottom, centred on the face. tests/accuracy/legibility.py reads this table too,
// so each line of the poster must be on a line of its own.
struct PosterLine {
  const char* words;  // A to Z and spaces
  float cap_height_m;
  float baseline_m;  // above the centre of the face
};
inline constexpr PosterLine kPosterLines[] = {
    {"THE QUICK BROWN FOX JUMPS OVER", 0.020f, 0.205f},
    {"A LAZY DOG WHILE FIVE BOXING", 0.020f, 0.160f},
    {"WIZARDS PACK THEIR HEAVY BAGS", 0.020f, 0.115f},
    {"SPHINX OF BLACK QUARTZ JUDGE MY QUIET VOW", 0.012f, 0.040f},
    {"EVERY SMALL LETTER ON THIS POSTER IS READ", 0.012f, 0.010f},
    {"FROM ONE METRE AWAY WITH A DEPTH CAMERA", 0.012f, -0.020f},
};

// Returns the share of the point's footprint that is ink, 0 to 1.
float ink_of_poster(const TexturePoint& point);

}  // namespace hermite::synthetic
