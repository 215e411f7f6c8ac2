#include "core/synthetic/room_textures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/synthetic/room_letters.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3f;

std::uint32_t hash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = (static_cast<std::uint32_t>(y) * 0xd8163841u ^ seed) * 0xcb1ab31fu;
  h = ((static_cast<std::uint32_t>(x) * 0x8da6b343u) ^ h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

float uniform(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  return static_cast<float>(hash(x, y, seed) >> 8) * 0x1p-24f;
}

// Numbers from -1 to 1. A row of a noise lattice is this table from a position that depends on the
// row, which needs one hash per row instead of one per corner.
constexpr std::uint32_t kTableMask = 4095;
constexpr std::array<float, kTableMask + 2> kNoiseTable = [] {
  std::array<float, kTableMask + 2> table{};
  std::uint32_t state = 1;
  for (std::uint32_t i = 0; i <= kTableMask; ++i) {
    state = state * 1664525u + 1013904223u;
    std::uint32_t h = (state ^ (state >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    table[i] = static_cast<float>((h ^ (h >> 15)) >> 8) * 0x1p-23f - 1.0f;
  }
  table[kTableMask + 1] = table[0];
  return table;
}();

const float* lattice_row(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = (static_cast<std::uint32_t>(y) * 0xd8163841u ^ seed) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  return kNoiseTable.data() + ((static_cast<std::uint32_t>(x) + (h >> 16)) & kTableMask);
}

std::int32_t floor_int(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}

float smooth(float t) { return t * t * (3.0f - 2.0f * t); }
float mix(float a, float b, float t) { return a + (b - a) * t; }
Vector3f mix(const Vector3f& a, const Vector3f& b, float t) { return a + (b - a) * t; }
float clamp01(float x) { return std::clamp(x, 0.0f, 1.0f); }

// Returns noise from -1 to 1, with one lattice cell per unit and a continuous derivative.
float noise(float x, float y, std::uint32_t seed) {
  const std::int32_t ix = floor_int(x), iy = floor_int(y);
  const float tx = smooth(x - static_cast<float>(ix)), ty = smooth(y - static_cast<float>(iy));
  const float* low = lattice_row(ix, iy, seed);
  const float* high = lattice_row(ix, iy + 1, seed);
  return mix(mix(low[0], low[1], tx), mix(high[0], high[1], tx), ty);
}

// Returns how much of a pattern of this wavelength a pixel can show: all from 4 footprints on,
// nothing below 2 (Nyquist).
float visible(float wavelength_m, float footprint_m) {
  return clamp01(wavelength_m / (2.0f * footprint_m) - 1.0f);
}

struct Octaves {
  float longest_m;
  int count;
  float stretch = 1;  // ratio of the wavelengths across and along
  float falloff = 0.6f;
};

// Sums octaves of noise. Each lattice is rotated relative to the one before, to hide its axes;
// stretched ones keep their direction.
float fractal(const TexturePoint& p, const Octaves& octaves, std::uint32_t seed) {
  float sum = 0, amplitude = 1, wavelength_m = octaves.longest_m;
  float u_m = p.u_m, v_m = p.v_m * octaves.stretch;
  for (int i = 0; i < octaves.count; ++i, amplitude *= octaves.falloff, wavelength_m *= 0.45f) {
    const float shown = visible(wavelength_m, p.footprint_m);
    if (shown <= 0) break;
    sum +=
        shown * amplitude *
        noise(u_m / wavelength_m, v_m / wavelength_m, seed + static_cast<std::uint32_t>(i) * 101u);
    if (octaves.stretch == 1.0f) {
      const float turned_m = 0.8f * u_m - 0.6f * v_m;
      v_m = 0.6f * u_m + 0.8f * v_m;
      u_m = turned_m;
    }
  }
  return sum;
}

// Returns 1 inside [low, high] and 0 outside, with steps as wide as a pixel.
float band(float x, float low, float high, float footprint) {
  const float width = std::max(footprint, 1e-4f);
  return clamp01((x - low) / width + 0.5f) * clamp01((high - x) / width + 0.5f);
}

// Returns the distance to the nearest multiple of `period`.
float to_line(float x, float period) {
  return std::abs(x - period * std::floor(x / period + 0.5f));
}

// Returns 1 near multiples of the period, as lines of this width.
float lines(float x, float period, float width, float footprint) {
  return band(to_line(x, period), -1, 0.5f * width, footprint) * visible(2 * period, footprint);
}

// Returns -1 or 1 in alternating stripes, with edges as wide as a pixel.
float square_wave(float x, float period, float footprint) {
  const float edge = std::max(footprint, 1e-4f);
  const float nearest = 0.25f * period - to_line(x, period);
  return std::clamp(2.0f * nearest / edge, -1.0f, 1.0f) * visible(period, footprint);
}

Vector3f plaster(const Material& m, const TexturePoint& p) {
  const std::uint32_t seed = m.seed + static_cast<std::uint32_t>(p.face) * 977u;
  const float tone = fractal(p, {0.55f, 6, 1, 0.72f}, seed);
  // Specks about 2 cm apart, from two lattices at an angle, so that they do not form rows.
  const float x = p.u_m / 0.022f, y = p.v_m / 0.022f;
  const float specks =
      noise(x, y, seed + 7) + noise(0.8f * x - 0.6f * y, 0.6f * x + 0.8f * y, seed + 8);
  const float speck = visible(0.022f, p.footprint_m) * smooth(clamp01(specks * 2.5f - 1.9f));
  return mix(m.first, m.second, clamp01(0.35f + 0.28f * tone)) * (1.0f - 0.3f * speck);
}

Vector3f wallpaper(const Material& m, const TexturePoint& p) {
  const float stripe = square_wave(p.u_m, 0.32f, p.footprint_m);
  const float row = std::floor(p.v_m / 0.24f + 0.5f);
  const float shift = std::fmod(std::abs(row), 2.0f) * 0.16f;
  const float diamond = to_line(p.u_m + shift, 0.32f) + 0.7f * to_line(p.v_m, 0.24f);
  const float motif =
      band(diamond, -1, 0.055f, p.footprint_m) - band(diamond, -1, 0.025f, p.footprint_m);
  const Vector3f base = plaster(m, p) * (1.0f + 0.10f * stripe);
  return mix(base, m.second * 0.55f, 0.75f * clamp01(motif));
}

Vector3f wood_grain(const Material& m, const TexturePoint& p, std::uint32_t seed) {
  const float figure = fractal(p, {0.5f, 5, 9, 0.68f}, seed);
  const float rings = std::sin(26.0f * (p.v_m + 0.05f * figure)) * visible(0.24f, p.footprint_m);
  return mix(m.first, m.second, clamp01(0.42f + 0.24f * figure + 0.16f * rings));
}

Vector3f planks(const Material& m, const TexturePoint& p) {
  constexpr float kWidth_m = 0.13f, kLength_m = 1.1f;
  const std::int32_t row = floor_int(p.v_m / kWidth_m);
  const float along = p.u_m + kLength_m * uniform(row, 3, m.seed);
  const std::int32_t plank = floor_int(along / kLength_m);
  const std::uint32_t seed = hash(row, plank, m.seed);
  const float tone = 0.72f + 0.5f * static_cast<float>(seed & 255u) / 255.0f;
  const float gap = std::max(lines(p.v_m, kWidth_m, 0.004f, p.footprint_m),
                             lines(along, kLength_m, 0.004f, p.footprint_m));
  return wood_grain(m, p, seed) * (tone * (1.0f - 0.6f * gap));
}

Vector3f rug(const Material& m, const TexturePoint& p) {
  const float edge = std::min(p.half_width_m - std::abs(p.u_m), p.half_height_m - std::abs(p.v_m));
  const float f = p.footprint_m;
  const Vector3f cream = linear_from_srgb(0xe9dcc0), ochre = linear_from_srgb(0xc78a3b);
  const float diamond = to_line(p.u_m, 0.36f) / 0.18f + to_line(p.v_m, 0.30f) / 0.15f;
  Vector3f color = mix(m.first, m.second, band(diamond, -1, 0.92f, f / 0.15f));
  color = mix(color, cream, band(diamond, 0.55f, 0.72f, f / 0.15f));
  color = mix(color, ochre, band(diamond, -1, 0.28f, f / 0.15f));
  color = mix(color, m.second * 0.6f, band(edge, -1, 0.15f, f));
  const float teeth = square_wave(p.u_m, 0.09f, f) * square_wave(p.v_m, 0.09f, f);
  color = mix(color, cream, band(edge, 0.045f, 0.105f, f) * (0.5f + 0.5f * teeth));
  color = mix(color, ochre, band(edge, 0.012f, 0.030f, f));
  return color * (0.95f + 0.16f * fractal(p, {0.07f, 4, 1, 0.8f}, m.seed));
}

Vector3f fabric(const Material& m, const TexturePoint& p) {
  const std::uint32_t seed = m.seed + static_cast<std::uint32_t>(p.face) * 31u;
  const float f = p.footprint_m;
  const float plaid = 0.5f * (lines(p.u_m, 0.12f, 0.018f, f) + lines(p.v_m, 0.12f, 0.018f, f));
  const float weave = visible(0.012f, f) * std::sin(p.u_m * 523.0f) * std::sin(p.v_m * 523.0f);
  const float tone = 0.95f + 0.15f * fractal(p, {0.25f, 5, 1, 0.8f}, seed) + 0.08f * weave;
  return mix(m.first, m.second, 0.8f * plaid) * tone;
}

Vector3f book(const Material& m, const TexturePoint& p) {
  const float height = p.v_m / p.half_height_m, f = p.footprint_m;  // -1 to 1 up the spine
  const float fv = f / p.half_height_m;
  const float bands = band(height, 0.62f, 0.72f, fv) + band(height, -0.78f, -0.70f, fv);
  const bool letter =
      noise(1.7f, p.v_m / 0.012f, m.seed) > -0.1f && std::abs(p.u_m) < 0.5f * p.half_width_m;
  const float title = letter ? band(height, -0.35f, 0.40f, fv) * visible(0.02f, f) : 0.0f;
  const Vector3f cover = m.first * (0.95f + 0.12f * fractal(p, {0.06f, 3}, m.seed));
  return mix(cover, m.second, clamp01(bands + 0.8f * title));
}

Vector3f landscape(const Material& m, const TexturePoint& p) {
  const float f = p.footprint_m / p.half_height_m;
  const float x = p.u_m / p.half_height_m, y = p.v_m / p.half_height_m;
  Vector3f color =
      mix(linear_from_srgb(0xf6d9a8), linear_from_srgb(0x6fa3cf), clamp01(0.5f + 0.6f * y));
  const float cloud = fractal(p, {0.25f, 4, 2.5f}, m.seed + 5);
  color = mix(color, Vector3f::Constant(0.9f), clamp01(0.5f * cloud));
  const float sun = std::hypot(x - 0.4f, y - 0.45f);
  color = mix(color, linear_from_srgb(0xf2703a), band(sun, -1, 0.16f, f));
  for (int hill = 0; hill < 4; ++hill) {
    const auto k = static_cast<float>(hill);
    const float top =
        0.15f - 0.28f * k +
        0.22f * noise(x * (1.3f + 0.6f * k), k * 5.0f, m.seed + static_cast<std::uint32_t>(hill));
    const Vector3f green =
        mix(m.first, m.second, k / 3.0f) * (1.0f + 0.25f * fractal(p, {0.06f, 4}, m.seed + 40));
    color = mix(color, green, band(y, -9, top, f));
  }
  return color;
}

Vector3f mosaic(const Material& m, const TexturePoint& p) {
  const float cell_m = 0.32f * std::min(p.half_width_m, p.half_height_m);
  const std::int32_t ix = floor_int(p.u_m / cell_m), iy = floor_int(p.v_m / cell_m);
  float nearest = 9, second = 9;
  std::uint32_t owner = 0;
  for (std::int32_t y = iy - 1; y <= iy + 1; ++y)
    for (std::int32_t x = ix - 1; x <= ix + 1; ++x) {
      const float dx = static_cast<float>(x) + uniform(x, y, m.seed) - p.u_m / cell_m;
      const float dy = static_cast<float>(y) + uniform(x, y, m.seed + 1) - p.v_m / cell_m;
      const float distance = std::sqrt(dx * dx + dy * dy);
      second = std::min(second, std::max(distance, nearest));
      if (distance < nearest) owner = hash(x, y, m.seed + 2);
      nearest = std::min(nearest, distance);
    }
  const Vector3f palette[] = {m.first, m.second, linear_from_srgb(0xf0e6d2),
                              linear_from_srgb(0xe0a030), linear_from_srgb(0x30343f)};
  const Vector3f color = palette[owner % 5] * (0.92f + 0.12f * fractal(p, {0.05f, 3}, m.seed + 9));
  return color * (1.0f - 0.75f * band(second - nearest, -1, 0.07f, p.footprint_m / cell_m));
}

Vector3f rings(const Material& m, const TexturePoint& p) {
  const float scale = std::min(p.half_width_m, p.half_height_m), f = p.footprint_m / scale;
  Vector3f color = linear_from_srgb(0xefe7d6);
  for (int i = 0; i < 7; ++i) {
    const float x = p.u_m / scale - 1.6f * (uniform(i, 1, m.seed) - 0.5f),
                y = p.v_m / scale - 1.6f * (uniform(i, 2, m.seed) - 0.5f);
    const float radius = std::sqrt(x * x + y * y), size = 0.25f + 0.4f * uniform(i, 3, m.seed);
    const float inside = band(radius, -1, size, f),
                ripple = 0.5f + 0.5f * square_wave(radius, 0.16f, f);
    color = mix(color, mix(m.first, m.second, uniform(i, 4, m.seed)),
                inside * (0.35f + 0.55f * ripple));
  }
  return color * (0.95f + 0.08f * fractal(p, {0.05f, 3}, m.seed));
}

Vector3f ceramic(const Material& m, const TexturePoint& p) {
  const float stripes =
      0.5f + 0.5f * square_wave(p.v_m + 0.008f * std::sin(p.u_m * 60.0f), 0.075f, p.footprint_m);
  return mix(m.first, m.second, stripes) * (0.95f + 0.12f * fractal(p, {0.06f, 4}, m.seed));
}

Vector3f tiles(const Material& m, const TexturePoint& p) {
  const float checker = 0.5f + 0.5f * square_wave(p.u_m, 0.18f, p.footprint_m) *
                                   square_wave(p.v_m, 0.18f, p.footprint_m);
  return mix(m.first, m.second, checker) *
         (0.95f + 0.18f * fractal(p, {0.12f, 5, 1, 0.7f}, m.seed));
}

Vector3f leaves(const Material& m, const TexturePoint& p) {
  const float tone = fractal(p, {0.06f, 4, 1, 0.8f}, m.seed);
  return mix(m.first, m.second, clamp01(0.5f + 0.55f * tone));
}

Vector3f metal(const Material& m, const TexturePoint& p) {
  return mix(m.first, m.second, clamp01(0.4f + 0.3f * fractal(p, {0.12f, 4, 6}, m.seed)));
}

Vector3f sky(const Material& m, const TexturePoint& p) {
  const float height = p.v_m / p.half_height_m;
  const float cloud = clamp01(0.25f + 0.8f * fractal(p, {0.4f, 5, 2}, m.seed));
  Vector3f color =
      mix(mix(m.first, m.second, 0.5f + 0.5f * height), Vector3f::Constant(0.95f), cloud);
  const float trees = -0.45f + 0.2f * noise(p.u_m / 0.18f, 0.5f, m.seed) +
                      0.1f * noise(p.u_m / 0.05f, 0.5f, m.seed);
  const Vector3f green =
      linear_from_srgb(0x5f7f4a) * (1.0f + 0.4f * fractal(p, {0.08f, 4}, m.seed + 3));
  return mix(color, green, band(height, -9, trees, p.footprint_m / p.half_height_m));
}

Vector3f screen(const Material& m, const TexturePoint& p) {
  const float line = std::floor(p.v_m / 0.016f);
  const auto row = static_cast<std::int32_t>(line);
  const float length = p.half_width_m * (-0.7f + 1.5f * uniform(row, 0, m.seed));
  const float indent = -p.half_width_m * (0.9f - 0.25f * uniform(row / 3, 1, m.seed));
  const float text = band(p.u_m, indent, length, p.footprint_m) *
                     band(p.v_m - line * 0.016f, 0.004f, 0.012f, p.footprint_m);
  const Vector3f ink = mix(m.second, linear_from_srgb(0xe8b86a), uniform(row, 2, m.seed));
  return mix(m.first, ink, text * visible(0.02f, p.footprint_m) * 0.8f);
}

Vector3f paint(const Material& m, const TexturePoint& p) {
  return mix(m.first, m.second,
             clamp01(0.5f + 0.25f * fractal(p, {0.9f, 3},
                                            m.seed + static_cast<std::uint32_t>(p.face) * 977u)));
}

}  // namespace

Vector3f texture_color(const Material& material, const TexturePoint& point) {
  switch (material.pattern) {
    case Pattern::kPlaster: return plaster(material, point);
    case Pattern::kWallpaper: return wallpaper(material, point);
    case Pattern::kPlanks: return planks(material, point);
    case Pattern::kWood:
      return wood_grain(material, point,
                        material.seed + static_cast<std::uint32_t>(point.face) * 57u);
    case Pattern::kRug: return rug(material, point);
    case Pattern::kFabric: return fabric(material, point);
    case Pattern::kBook: return book(material, point);
    case Pattern::kLandscape: return landscape(material, point);
    case Pattern::kMosaic: return mosaic(material, point);
    case Pattern::kRings: return rings(material, point);
    case Pattern::kCeramic: return ceramic(material, point);
    case Pattern::kTiles: return tiles(material, point);
    case Pattern::kLeaves: return leaves(material, point);
    case Pattern::kMetal: return metal(material, point);
    case Pattern::kSky: return sky(material, point);
    case Pattern::kScreen: return screen(material, point);
    case Pattern::kPaint: return paint(material, point);
    case Pattern::kLetters: return mix(material.first, material.second, ink_of_poster(point));
  }
  return material.first;
}

Vector3f linear_from_srgb(std::uint32_t rrggbb) {
  const auto channel = [](std::uint32_t byte) {
    const float value = static_cast<float>(byte & 255u) / 255.0f;
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
  };
  return {channel(rrggbb >> 16), channel(rrggbb >> 8), channel(rrggbb)};
}

}  // namespace hermite::synthetic
