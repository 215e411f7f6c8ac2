#include "core/synthetic/room_pieces.h"

#include <cmath>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

}  // namespace

void add_trim(Furnisher& f) {
  const int white = f.material(Pattern::kWood, 0xf2ede2, 0xd9d0bf);
  const int beam = f.material(Pattern::kWood, 0x8a6038, 0x54361c);
  const double x = kHalfLength_m, y = kHalfWidth_m, out = kSunk_m, thick = 0.016, high = 0.09;
  f.box({-x - out, x + out}, {y - thick, y + out}, {-out, high}, white);
  f.box({-x - out, x + out}, {-y - out, -y + thick}, {-out, high}, white);
  f.box({-x - out, -x + thick}, {-y - out, y + out}, {-out, high}, white);
  f.box({x - thick, x + out}, {-y - out, y + out}, {-out, high}, white);
  for (const double at : {-1.2, 1.2})
    f.box({at - 0.07, at + 0.07}, {-y - out, y + out}, {kRoomHeight_m - 0.12, kRoomHeight_m + out},
          beam);
  const int rug = f.material(Pattern::kRug, 0xa33b35, 0x27425f);
  f.box({-1.3, 1.3}, {-0.95, 0.95}, {-out, 0.010}, rug);
}

void add_bookshelf(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0xb98754, 0x7d5026);
  constexpr Span kX{-2.08, -0.92};
  const double back = kHalfWidth_m, front = back - 0.28;
  for (const double x : {kX.low, -1.5, kX.high})
    f.box({x - 0.012, x + 0.012}, {front, back + kSunk_m}, {-kSunk_m, 1.96}, wood);
  f.box({kX.low, kX.high}, {back - 0.012, back + kSunk_m}, {-kSunk_m, 1.955}, wood);
  constexpr double kShelves[] = {0.10, 0.47, 0.84, 1.21, 1.58, 1.95};
  for (const double z : kShelves)
    f.box({kX.low, kX.high}, {front + 0.004, back + kSunk_m}, {z - 0.011, z + 0.011}, wood);

  constexpr std::uint32_t kCovers[] = {0xa23b2c, 0x24506e, 0xd9a441, 0x3f6b4a, 0x6b3f63,
                                       0xd8cfb8, 0x2b2f3a, 0xc56a3a, 0x7b9aa8, 0x8f2f45};
  std::uint32_t dice = 12345;
  const auto roll = [&dice](double low, double high) {
    dice = dice * 1664525u + 1013904223u;
    return low + (high - low) * static_cast<double>(dice >> 8) * 0x1p-24;
  };
  int covers[10];
  for (int i = 0; i < 10; ++i)
    covers[i] = f.material(Pattern::kBook, kCovers[i], i % 2 ? 0xf0dfae : 0xd9b56a);
  for (std::size_t shelf = 0; shelf + 1 < std::size(kShelves); ++shelf)
    for (const Span bay : {Span{-2.06, -1.52}, Span{-1.48, -0.94}}) {
      const double end = bay.low + roll(0.30, 0.54);
      for (double x = bay.low; x < end - 0.03;) {
        const double width = roll(0.028, 0.06), height = roll(0.20, 0.32), depth = roll(0.15, 0.21);
        if (x + width > bay.high) break;
        f.box({x, x + width}, {back - 0.02 - depth, back + 0.02},
              {kShelves[shelf] - 0.005, kShelves[shelf] + 0.011 + height},
              covers[static_cast<int>(roll(0, 9.999))]);
        x += width + 0.003;
      }
    }
}

void add_sideboard(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0xd2a46c, 0x9a6a38),
            dark = f.material(Pattern::kMetal, 0x50463c, 0x2c2620);
  const int vase = f.material(Pattern::kCeramic, 0x2f6f83, 0xe8e0cf),
            globe = f.material(Pattern::kMosaic, 0x3f7fa8, 0x6f9a58);
  const int brass = f.material(Pattern::kMetal, 0xd8b060, 0x94702c);
  const double back = kHalfWidth_m, front = back - 0.42;
  f.box({-0.55, 0.85}, {front, back + kSunk_m}, {0.14, 0.78}, wood);
  f.box({-0.58, 0.88}, {front - 0.015, back + kSunk_m}, {0.77, 0.80}, dark);
  for (const double x : {-0.5, 0.8})
    f.rod({x, front + 0.05, -kSunk_m}, {x, front + 0.05, 0.2}, 0.018, dark);
  for (int door = 0; door < 3; ++door) {
    const double x = -0.54 + 0.463 * door;
    f.box({x + 0.008, x + 0.445}, {front - 0.014, front + 0.02}, {0.16, 0.755}, wood);
    f.sphere({x + 0.40, front - 0.025, 0.50}, 0.018, brass);
  }
  const std::size_t before_vase = f.count();
  f.column(-0.30, back - 0.22, {0.78, 1.04}, 0.075, vase);
  f.torus({-0.30, back - 0.22, 1.04}, 0.066, 0.016, vase);
  f.name("vase", before_vase);
  const std::size_t before_globe = f.count();
  f.sphere({0.10, back - 0.20, 1.00}, 0.13, globe);
  f.column(0.10, back - 0.20, {0.78, 0.88}, 0.02, brass);
  f.column(0.10, back - 0.20, {0.78, 0.82}, 0.07, brass);
  f.name("globe", before_globe);
  const std::size_t before_ring = f.count();
  Shape& ring = f.torus({0.58, back - 0.20, 0.955}, 0.13, 0.032,
                        f.material(Pattern::kCeramic, 0xd0552f, 0xf0d9a0));
  turn(ring, 90, Vector3d::UnitX());
  turn(ring, 25, Vector3d::UnitZ());
  f.name("ring", before_ring);

  const int painting = f.material(Pattern::kLandscape, 0x6b8f5a, 0x2c4a3a),
            frame = f.material(Pattern::kWood, 0x6a4526, 0x3c2412);
  f.box({-0.42, 0.72}, {back - 0.022, back + kSunk_m}, {1.33, 2.03}, frame);
  f.box({-0.37, 0.67}, {back - 0.027, back + kSunk_m}, {1.38, 1.98}, painting);
}

void add_floor_lamp(Furnisher& f) {
  const int metal = f.material(Pattern::kMetal, 0x6a6660, 0x35322e);
  const int shade = f.material(Pattern::kFabric, 0xf6e3b4, 0xe0a860, 0.55f);
  f.column(1.35, 1.45, {-kSunk_m, 0.025}, 0.15, metal);
  f.column(1.35, 1.45, {0.0, 1.62}, 0.011, metal);
  f.column(1.35, 1.45, {1.40, 1.68}, 0.17, shade);
}

void add_sofa(Furnisher& f) {
  const int cloth = f.material(Pattern::kFabric, 0x4f7a74, 0x2f4f52),
            cushion = f.material(Pattern::kMosaic, 0xd08a3c, 0xb04a38);
  const int wood = f.material(Pattern::kWood, 0x7a5230, 0x4a2e18);
  const double back = kHalfLength_m;
  f.box({1.58, back - 0.04}, {-1.0, 0.80}, {0.10, 0.30}, cloth);
  f.box({1.54, 2.12}, {-0.84, -0.11}, {0.28, 0.45}, cloth);
  f.box({1.54, 2.12}, {-0.10, 0.64}, {0.28, 0.45}, cloth);
  f.box({2.08, back - 0.05}, {-1.0, 0.80}, {0.12, 0.84}, cloth);
  for (const double y : {-0.93, 0.73}) {
    f.box({1.57, 2.30}, {y - 0.08, y + 0.08}, {0.12, 0.56}, cloth);
    f.rod({1.55, y, 0.56}, {2.30, y, 0.56}, 0.085, cloth);
  }
  for (const double y : {-0.9, 0.7})
    for (const double x : {1.66, 2.25}) f.column(x, y, {-kSunk_m, 0.14}, 0.025, wood);
  turn(f.box({1.90, 2.03}, {-0.76, -0.40}, {0.42, 0.78}, cushion), 14, Vector3d::UnitY());
  turn(f.box({1.88, 2.00}, {0.20, 0.58}, {0.43, 0.77},
             f.material(Pattern::kRings, 0xd8b04a, 0x2f5a78)),
       12, Vector3d::UnitY());
}

void add_window(Furnisher& f) {
  const int sky = f.material(Pattern::kSky, 0xdfeaf2, 0x6fa6d8, 0.9f),
            white = f.material(Pattern::kWood, 0xf4efe4, 0xdcd3c2);
  const int curtain = f.material(Pattern::kFabric, 0xc9603f, 0x8f3a2c),
            rail = f.material(Pattern::kMetal, 0x8a7a60, 0x4c4232);
  const double wall = kHalfLength_m;
  f.box({wall - 0.006, wall + kSunk_m}, {-0.75, 0.55}, {1.05, 2.20}, sky);
  for (const double y : {-0.75, -0.10, 0.55})
    f.box({wall - 0.035, wall + kSunk_m}, {y - 0.025, y + 0.025}, {1.03, 2.22}, white);
  for (const double z : {1.05, 1.62, 2.20})
    f.box({wall - 0.032, wall + kSunk_m}, {-0.77, 0.57}, {z - 0.022, z + 0.022}, white);
  f.box({wall - 0.13, wall + kSunk_m}, {-0.82, 0.62}, {0.99, 1.03}, white);
  f.rod({wall - 0.09, -1.18, 2.32}, {wall - 0.09, 0.98, 2.32}, 0.012, rail);
  for (const double y : {-1.18, 0.98}) f.sphere({wall - 0.09, y, 2.32}, 0.028, rail);
  for (int fold = 0; fold < 6; ++fold)
    for (const double start : {-1.10, 0.62})
      f.column(wall - 0.085 + 0.012 * (fold % 2), start + 0.055 * fold, {0.90, 2.33}, 0.034,
               curtain);
}

void add_desk(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0xe0b880, 0xa87844),
            dark = f.material(Pattern::kMetal, 0x3c3e42, 0x1e2024);
  const int screen = f.material(Pattern::kScreen, 0x1c2733, 0x7fd0c0, 0.5f),
            mug = f.material(Pattern::kCeramic, 0xd9542f, 0xf2e6cf);
  const double wall = -kHalfWidth_m;
  f.box({-1.25, 0.25}, {wall + 0.02, wall + 0.64}, {0.715, 0.745}, wood);
  for (const double x : {-1.20, 0.20})
    for (const double y : {wall + 0.07, wall + 0.59}) f.column(x, y, {-kSunk_m, 0.73}, 0.017, dark);
  const std::size_t before_screen = f.count();
  f.box({-0.80, -0.20}, {wall + 0.18, wall + 0.196}, {0.85, 1.20}, dark);
  f.box({-0.785, -0.215}, {wall + 0.185, wall + 0.1975}, {0.865, 1.185}, screen);
  f.column(-0.50, wall + 0.17, {0.72, 0.95}, 0.016, dark);
  f.column(-0.50, wall + 0.18, {0.72, 0.756}, 0.10, dark);
  f.name("screen", before_screen);
  f.box({-0.72, -0.28}, {wall + 0.36, wall + 0.50}, {0.72, 0.762},
        f.material(Pattern::kTiles, 0xd4d4d0, 0x606468));
  const std::size_t before_mug = f.count();
  f.column(-0.02, wall + 0.36, {0.73, 0.845}, 0.042, mug);
  turn(f.torus({0.028, wall + 0.36, 0.79}, 0.032, 0.007, mug), 90, Vector3d::UnitX());
  f.name("mug", before_mug);
  const int lamp = f.material(Pattern::kMetal, 0xc8382c, 0x86201a);
  f.column(-1.08, wall + 0.22, {0.72, 0.765}, 0.08, lamp);
  f.rod({-1.08, wall + 0.22, 0.75}, {-1.16, wall + 0.24, 1.10}, 0.009, lamp);
  f.rod({-1.16, wall + 0.24, 1.10}, {-0.95, wall + 0.34, 1.27}, 0.009, lamp);
  f.sphere({-0.94, wall + 0.345, 1.25}, 0.065, lamp);
  const int covers[] = {f.material(Pattern::kBook, 0x2f6a7a, 0xf0dfae),
                        f.material(Pattern::kBook, 0xb5482f, 0xf0dfae),
                        f.material(Pattern::kBook, 0xd8b04a, 0x4a3020)};
  for (int i = 0; i < 3; ++i) {
    Shape& book = f.box({0.02, 0.19}, {wall + 0.08, wall + 0.31},
                        {0.744 + 0.036 * i - (i ? 0.0 : 0.02), 0.78 + 0.036 * i}, covers[i]);
    turn(book, 9.0 * i - 6.0, Vector3d::UnitZ());
  }
  const int frame = f.material(Pattern::kWood, 0x2c2622, 0x15110e);
  const int paintings[] = {f.material(Pattern::kRings, 0xc94f3a, 0x2b5e7d),
                           f.material(Pattern::kMosaic, 0x2f7f86, 0xc8543a),
                           f.material(Pattern::kLandscape, 0x8a7a4a, 0x3f4f3a)};
  for (int i = 0; i < 3; ++i) {
    const double x = -1.22 + 0.52 * i;
    f.box({x, x + 0.42}, {wall - kSunk_m, wall + 0.02}, {1.42, 1.96}, frame);
    f.box({x + 0.03, x + 0.39}, {wall - kSunk_m, wall + 0.024}, {1.45, 1.93}, paintings[i]);
  }
}

void add_chair(Furnisher& f, double x, double y, double angle_deg) {
  const int wood = f.material(Pattern::kWood, 0xa8703c, 0x6a4320),
            seat = f.material(Pattern::kFabric, 0xb8503c, 0x7a2f28);
  const std::size_t first = f.out.shapes.size();
  f.box({x - 0.20, x + 0.20}, {y - 0.20, y + 0.20}, {0.43, 0.465}, seat);
  for (const double side : {-0.18, 0.18}) {
    f.rod({x + 1.12 * side, y + 0.21, -kSunk_m}, {x + side, y + 0.17, 0.44}, 0.010, wood);
    f.rod({x + 1.12 * side, y - 0.22, -kSunk_m}, {x + side, y - 0.18, 0.90}, 0.010, wood);
    f.rod({x + 1.06 * side, y + 0.19, 0.20}, {x + 1.06 * side, y - 0.20, 0.20}, 0.005, wood);
  }
  f.box({x - 0.18, x + 0.18}, {y - 0.187, y - 0.177}, {0.68, 0.88}, wood);
  for (const double z : {0.55, 0.61})
    f.rod({x - 0.18, y - 0.184, z}, {x + 0.18, y - 0.184, z}, 0.006, wood);
  turn_group(f.out, first, angle_deg, x, y);
}

void add_door(Furnisher& f) {
  const int paint = f.material(Pattern::kWood, 0xd8cdb8, 0xb3a488),
            brass = f.material(Pattern::kMetal, 0xd8b060, 0x94702c);
  const int frame = f.material(Pattern::kWood, 0xf4efe4, 0xdcd3c2);
  const double wall = -kHalfWidth_m;
  f.box({0.98, 1.84}, {wall - kSunk_m, wall + 0.020}, {-kSunk_m, 2.04}, paint);
  for (const Span z : {Span{0.20, 0.92}, Span{1.06, 1.90}})
    for (const Span x : {Span{1.08, 1.37}, Span{1.45, 1.74}})
      f.box(x, {wall - kSunk_m, wall + 0.034}, z, paint);
  for (const double x : {0.94, 1.88})
    f.box({x - 0.045, x + 0.045}, {wall - kSunk_m, wall + 0.042}, {-kSunk_m, 2.12}, frame);
  f.box({0.90, 1.92}, {wall - kSunk_m, wall + 0.045}, {2.035, 2.13}, frame);
  f.rod({1.06, wall, 1.0}, {1.06, wall + 0.075, 1.0}, 0.010, brass);
  f.sphere({1.06, wall + 0.085, 1.0}, 0.028, brass);
}

void add_plant(Furnisher& f) {
  const int pot = f.material(Pattern::kCeramic, 0xb9623a, 0x8a4325),
            stem = f.material(Pattern::kWood, 0x7a5a34, 0x4a3318);
  const int leaf = f.material(Pattern::kLeaves, 0x2f5f2c, 0x8fb858);
  const double x = -2.0, y = 0.95;
  f.column(x, y, {-kSunk_m, 0.34}, 0.16, pot);
  f.torus({x, y, 0.34}, 0.15, 0.022, pot);
  f.column(x, y, {0.2, 0.345}, 0.14, stem);
  for (int i = 0; i < 7; ++i) {
    const double angle = 0.9 + 2.4 * i, reach = 0.11 + 0.025 * (i % 3), top = 0.75 + 0.12 * i;
    const Vector3d tip(x + reach * std::cos(angle), y + reach * std::sin(angle), top);
    f.rod({x, y, 0.30}, tip, 0.008, stem);
    f.sphere(tip, 0.105 - 0.006 * i, leaf);
    f.sphere(tip + Vector3d(0.07 * std::cos(angle + 1), 0.07 * std::sin(angle + 1), 0.05), 0.07,
             leaf);
  }
}

void add_west_wall(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0xc08a52, 0x855728),
            frame = f.material(Pattern::kWood, 0xe8e0d0, 0xc9bda6);
  const double wall = -kHalfLength_m;
  f.box({wall - kSunk_m, wall + 0.022}, {-0.55, 0.45}, {1.22, 1.98}, frame);
  f.box({wall - kSunk_m, wall + 0.026}, {-0.51, 0.41}, {1.26, 1.94},
        f.material(Pattern::kMosaic, 0x2f5f86, 0xd0683a));
  const std::size_t before_cabinet = f.count();
  f.box({wall - kSunk_m, wall + 0.40}, {-0.62, 0.52}, {-kSunk_m, 0.42},
        f.material(Pattern::kTiles, 0xe4d8c0, 0x5f7f86));
  f.box({wall - kSunk_m, wall + 0.43}, {-0.65, 0.55}, {0.40, 0.445}, wood);
  f.name("cabinet", before_cabinet);
  const std::size_t before_bowl = f.count();
  f.sphere({wall + 0.21, -0.40, 0.56}, 0.125, f.material(Pattern::kRings, 0xe0a030, 0x8f2f45));
  f.name("bowl", before_bowl);
  f.torus({wall + 0.22, 0.05, 0.48}, 0.14, 0.042,
          f.material(Pattern::kCeramic, 0x4a7f5a, 0xf0e6d0));
  const std::size_t before_jar = f.count();
  f.column(wall + 0.18, 0.38, {0.43, 0.72}, 0.055,
           f.material(Pattern::kCeramic, 0x2c4f7a, 0xe4d2a8));
  f.name("jar", before_jar);
  f.column(-2.08, -1.58, {-kSunk_m, kRoomHeight_m + kSunk_m}, 0.17,
           f.material(Pattern::kTiles, 0xd9cdb6, 0x9c5a44));
  for (const double z : {0.05, kRoomHeight_m - 0.05})
    f.torus({-2.08, -1.58, z}, 0.17, 0.045, frame);
}

void add_divider(Furnisher& f) {
  const int panel = f.material(Pattern::kMosaic, 0x8a3f55, 0x3f7f86),
            post = f.material(Pattern::kWood, 0x4a2e18, 0x2a180c);
  const std::size_t first = f.out.shapes.size();
  f.box({-2.02, -1.62}, {-0.985, -0.975}, {0.06, 1.42}, panel);
  for (const double x : {-2.03, -1.61}) f.column(x, -0.98, {-kSunk_m, 1.46}, 0.014, post);
  turn_group(f.out, first, -20, -1.82, -0.98);
}

void add_coffee_table(Furnisher& f) {
  const int wood = f.material(Pattern::kWood, 0x9a6436, 0x5c3717),
            brass = f.material(Pattern::kMetal, 0xd8b060, 0x94702c);
  f.column(0, 0, {0.415, 0.445}, 0.42, wood);
  for (int leg = 0; leg < 3; ++leg) {
    const double angle = 0.4 + leg * 2 * M_PI / 3;
    f.rod({0.34 * std::cos(angle), 0.34 * std::sin(angle), -kSunk_m},
          {0.24 * std::cos(angle), 0.24 * std::sin(angle), 0.43}, 0.014, brass);
  }
  f.torus({0.14, 0.10, 0.482}, 0.105, 0.038, f.material(Pattern::kCeramic, 0xc8722f, 0xf4e3b8));
  f.sphere({-0.16, 0.12, 0.515}, 0.072, f.material(Pattern::kTiles, 0x2f6f83, 0xeae0c8));
  f.column(-0.06, -0.20, {0.43, 0.62}, 0.045, f.material(Pattern::kCeramic, 0x7a2f3a, 0xe8d0b0));
  turn(f.box({0.12, 0.30}, {-0.24, -0.10}, {0.43, 0.475},
             f.material(Pattern::kBook, 0x3f5f8a, 0xf0dfae)),
       20, Vector3d::UnitZ());
}

void add_toys(Furnisher& f) {
  const std::size_t before_ball = f.count();
  f.sphere({0.95, -1.15, 0.13}, 0.13, f.material(Pattern::kCeramic, 0xd93f2f, 0xf2ead8));
  f.name("ball", before_ball);
  const int blocks[] = {f.material(Pattern::kTiles, 0xe0a030, 0xf4e6c0),
                        f.material(Pattern::kTiles, 0x2f7f5a, 0xbfe0c4),
                        f.material(Pattern::kTiles, 0x2f5f9a, 0xc4d8ee)};
  const std::size_t before_blocks = f.count();
  turn(f.box({1.02, 1.14}, {0.98, 1.10}, {-0.02, 0.12}, blocks[0]), 20, Vector3d::UnitZ());
  turn(f.box({0.88, 1.00}, {1.08, 1.20}, {-0.02, 0.12}, blocks[1]), -12, Vector3d::UnitZ());
  turn(f.box({0.95, 1.07}, {1.02, 1.14}, {0.11, 0.23}, blocks[2]), 40, Vector3d::UnitZ());
  f.name("blocks", before_blocks);
}

}  // namespace hermite::synthetic
