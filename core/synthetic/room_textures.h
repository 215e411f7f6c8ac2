// Procedural textures of the synthetic room: detail from half a metre down to millimetres, faded
// out where a pixel could not resolve it. Deterministic, pure functions of a position on a face.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace hermite::synthetic {

enum class Pattern : std::uint8_t {
  kPlaster,    // a wall: blotches and grain
  kWallpaper,  // plaster with stripes and diamonds
  kPlanks,     // floor boards
  kWood,       // furniture
  kRug,        // borders and diamonds
  kFabric,     // weave with a plaid
  kBook,       // a spine with bands
  kLandscape,  // a painting: sky, sun and hills
  kMosaic,     // a painting: coloured cells
  kRings,      // a painting: overlapping rings
  kCeramic,    // glaze with bands
  kTiles,      // checker
  kLeaves,     // plants
  kMetal,      // brushed
  kSky,        // seen through a window
  kScreen,     // of a computer
  kPaint,      // almost uniform: a colour that hardly varies
  kLetters,    // the words of room_letters.h, in the second colour on the first
};

struct Material {
  Pattern pattern = Pattern::kPlaster;
  Eigen::Vector3f first = Eigen::Vector3f::Constant(0.5f);   // linear RGB, 0 to 1
  Eigen::Vector3f second = Eigen::Vector3f::Constant(0.5f);  // the pattern's other colour
  // 0: lit by the room; 1: emits its own colour.
  float glow = 0;
  std::uint32_t seed = 0;
};

struct TexturePoint {
  float u_m = 0, v_m = 0;                     // along the face, from its centre
  float half_width_m = 1, half_height_m = 1;  // of the face
  float footprint_m = 0;                      // side of the area that one pixel covers here
  int face = 0;                               // opposite faces look different
};

// Returns linear RGB, 0 to 1.
Eigen::Vector3f texture_color(const Material& material, const TexturePoint& point);

// Converts 0xRRGGBB in sRGB to linear RGB.
Eigen::Vector3f linear_from_srgb(std::uint32_t rrggbb);

}  // namespace hermite::synthetic
