#include "core/synthetic/world_pieces.h"

#include <Eigen/Geometry>

#include "core/synthetic/room_pieces.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

}  // namespace

void add_bed(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0x8a5c34, 0x54351c),
            sheet = f.material(Pattern::kFabric, 0xe6e0d2, 0xa8b8c4);
  const int blanket = f.material(Pattern::kMosaic, 0x35507c, 0xb8553a),
            pillow = f.material(Pattern::kFabric, 0xd8a070, 0xf2e6d0);
  for (const double x : {-0.46, 0.46})
    for (const double y : {-1.96, -0.1}) f.column(x, y, {-kSunk_m, 0.3}, 0.03, wood);
  f.box({-0.5, 0.5}, {-2.03, 0}, {0.20, 0.32}, wood);
  f.box({-0.5, 0.5}, {-0.05, kSunk_m}, {0.1, 1.0}, wood);
  f.box({-0.47, 0.47}, {-2.0, -0.04}, {0.28, 0.50}, sheet);
  f.box({-0.49, 0.49}, {-2.05, -0.65}, {0.34, 0.535}, blanket);
  turn(f.box({-0.38, 0.36}, {-0.52, -0.12}, {0.48, 0.60}, pillow), 5, Vector3d::UnitZ());
  turn(f.box({-0.10, 0.16}, {-0.66, -0.48}, {0.52, 0.70},
             f.material(Pattern::kRings, 0xc0503a, 0x2f6a7a)),
       20, Vector3d::UnitZ());
}

void add_wardrobe(Furnisher& f) {
  const int body = f.material(Pattern::kWood, 0x6f7f86, 0x46545c),
            door = f.material(Pattern::kWood, 0xd9cdb4, 0xa4937a);
  const int brass = f.material(Pattern::kMetal, 0xd8b060, 0x94702c),
            box = f.material(Pattern::kTiles, 0x8a3f35, 0xe0c9a0);
  f.box({-0.6, 0.6}, {-0.55, kSunk_m}, {-kSunk_m, 2.0}, body);
  for (const double x : {-0.3, 0.3}) {
    f.box({x - 0.285, x + 0.285}, {-0.565, -0.5}, {0.10, 1.95}, door);
    f.box({x - 0.20, x + 0.20}, {-0.575, -0.5}, {1.05, 1.85}, body);
    f.box({x - 0.20, x + 0.20}, {-0.575, -0.5}, {0.20, 0.92}, body);
    f.sphere({x > 0 ? 0.05 : -0.05, -0.58, 1.0}, 0.018, brass);
  }
  f.box({-0.45, 0.05}, {-0.45, -0.08}, {1.98, 2.22}, box);
}

void add_dresser(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0xc98f58, 0x8a5a30),
            knob = f.material(Pattern::kCeramic, 0xf0e8d8, 0x2f5f86);
  f.box({-0.55, 0.55}, {-0.40, kSunk_m}, {-kSunk_m, 0.85}, wood);
  f.box({-0.57, 0.57}, {-0.43, kSunk_m}, {0.84, 0.87}, wood);
  for (int drawer = 0; drawer < 3; ++drawer) {
    const double low = 0.08 + 0.255 * drawer;
    f.box({-0.51, 0.51}, {-0.415, -0.3}, {low, low + 0.235}, wood);
    for (const double x : {-0.25, 0.25}) f.sphere({x, -0.43, low + 0.12}, 0.02, knob);
  }
  f.column(-0.35, -0.2, {0.85, 1.10}, 0.06, f.material(Pattern::kCeramic, 0x7a4a8a, 0xe8d8b0));
  f.sphere({0.0, -0.22, 0.95}, 0.085, f.material(Pattern::kRings, 0x2f7f86, 0xd86a3a));
  turn(f.torus({0.33, -0.2, 0.99}, 0.10, 0.03, f.material(Pattern::kTiles, 0xd8b04a, 0x3a4a5a)), 90,
       Vector3d::UnitX());
}

void add_radiator(Furnisher& f) {
  const int enamel = f.material(Pattern::kWood, 0xf0ece2, 0xd0c8ba),
            pipe = f.material(Pattern::kMetal, 0xb08a60, 0x70563a);
  for (int rib = 0; rib < 9; ++rib) {
    const double x = -0.4 + 0.1 * rib;
    f.box({x - 0.036, x + 0.036}, {-0.12, -0.03}, {0.14, 0.74}, enamel);
  }
  f.rod({-0.45, -0.075, 0.22}, {0.45, -0.075, 0.22}, 0.02, enamel);
  f.rod({-0.45, -0.075, 0.66}, {0.45, -0.075, 0.66}, 0.02, enamel);
  f.rod({0.44, -0.075, -kSunk_m}, {0.44, -0.075, 0.22}, 0.012, pipe);
}

void add_coats(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0x7a4f2a, 0x48290f),
            brass = f.material(Pattern::kMetal, 0xd8b060, 0x94702c);
  f.box({-0.5, 0.5}, {-0.025, kSunk_m}, {1.62, 1.72}, wood);
  for (int hook = 0; hook < 5; ++hook)
    f.rod({-0.4 + 0.2 * hook, 0, 1.66}, {-0.4 + 0.2 * hook, -0.07, 1.68}, 0.008, brass);
  turn(f.box({-0.47, -0.12}, {-0.14, -0.03}, {0.75, 1.66},
             f.material(Pattern::kFabric, 0x3f5f4a, 0x20302a)),
       3, Vector3d::UnitY());
  turn(f.box({-0.05, 0.24}, {-0.12, -0.03}, {0.90, 1.66},
             f.material(Pattern::kFabric, 0xb8863a, 0x6a3a28)),
       -2, Vector3d::UnitY());
  f.sphere({0.40, -0.08, 1.60}, 0.08, f.material(Pattern::kMosaic, 0xa83a3a, 0xe8d8c0));
}

void add_workplace(Furnisher& f, int cloth, int screen) {
  const int top = f.material(Pattern::kWood, 0xd8bf98, 0xa88a60),
            steel = f.material(Pattern::kMetal, 0x6a6e74, 0x3a3c40);
  const int dark = f.material(Pattern::kMetal, 0x3c3e42, 0x1e2024),
            keys = f.material(Pattern::kTiles, 0xd4d4d0, 0x606468);
  const int paper = f.material(Pattern::kBook, 0xe8e4da, 0x4a4e58),
            mug = f.material(Pattern::kCeramic, 0x2f6f83, 0xf2e6cf);
  f.box({-0.75, 0.75}, {-0.73, -0.02}, {0.715, 0.745}, top);
  for (const double x : {-0.70, 0.70})
    for (const double y : {-0.68, -0.07}) f.column(x, y, {-kSunk_m, 0.73}, 0.02, steel);
  f.box({0.28, 0.68}, {-0.60, -0.08}, {-kSunk_m, 0.56}, steel);
  for (const double z : {0.08, 0.25, 0.42})
    f.box({0.30, 0.66}, {-0.615, -0.5}, {z, z + 0.13}, cloth);
  f.box({-0.80, 0.80}, {-0.015, 0.05}, {0.35, 1.15}, cloth);
  f.box({-0.30, 0.30}, {-0.22, -0.20}, {0.86, 1.20}, dark);
  f.box({-0.285, 0.285}, {-0.2215, -0.21}, {0.875, 1.185}, screen);
  f.column(0, -0.20, {0.72, 0.95}, 0.016, dark);
  f.column(0, -0.21, {0.72, 0.756}, 0.10, dark);
  f.box({-0.22, 0.22}, {-0.55, -0.41}, {0.72, 0.762}, keys);
  f.column(0.42, -0.48, {0.73, 0.835}, 0.04, mug);
  turn(f.box({-0.62, -0.41}, {-0.56, -0.27}, {0.72, 0.77}, paper), 8, Vector3d::UnitZ());
  add_chair(f, 0, -0.82, 0);
}

void add_rack(Furnisher& f) {
  const int board = f.material(Pattern::kWood, 0xb8a890, 0x847460),
            steel = f.material(Pattern::kMetal, 0x6a6e74, 0x3a3c40);
  const int binders[] = {f.material(Pattern::kBook, 0x2c4f7a, 0xf0e8d8),
                         f.material(Pattern::kBook, 0xa8382c, 0xf0e8d8),
                         f.material(Pattern::kBook, 0x4a6a3a, 0xf0e8d8),
                         f.material(Pattern::kBook, 0x30343a, 0xe0d8c0)};
  for (const double x : {-0.64, 0.64})
    f.box({x - 0.012, x + 0.012}, {-0.31, kSunk_m}, {-kSunk_m, 1.70}, steel);
  for (const double z : {0.08, 0.50, 0.92, 1.34, 1.68})
    f.box({-0.64, 0.64}, {-0.30, kSunk_m}, {z - 0.012, z + 0.012}, board);
  constexpr double kShelves[] = {0.092, 0.512, 0.932, 1.352};
  int place = 0;
  for (const double z : kShelves) {
    // Blocks of binders, with a gap at another position on each board.
    for (int slot = 0; slot < 5; ++slot, ++place) {
      if (slot == place % 4) continue;
      const double x = -0.60 + 0.245 * slot;
      f.box({x, x + 0.075}, {-0.28, -0.02}, {z - 0.005, z + 0.31}, binders[place % 4]);
      f.box({x + 0.08, x + 0.215}, {-0.265, -0.02}, {z - 0.005, z + 0.30 - 0.02 * (place % 3)},
            binders[(place + 1) % 4]);
    }
  }
}

void add_sconce(Furnisher& f) {
  const int metal = f.material(Pattern::kMetal, 0x8a8278, 0x4a443c),
            glass = f.material(Pattern::kPaint, 0xfff2d8, 0xf0dcb0, 0.7f);
  f.box({-0.05, 0.05}, {-0.03, kSunk_m}, {1.60, 1.78}, metal);
  f.column(0, -0.06, {1.62, 1.82}, 0.05, glass);
}

}  // namespace hermite::synthetic
