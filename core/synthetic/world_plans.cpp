#include "core/synthetic/world_plans.h"

#include "core/synthetic/room_pieces.h"
#include "core/synthetic/world_pieces.h"
#include "core/synthetic/world_walls.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector2d;

constexpr ShellLook kHomeShell{{Pattern::kPlaster, 0xe9e0cf, 0xc4b496},
                               {Pattern::kPlanks, 0xb58a58, 0x7a5230},
                               {Pattern::kPlaster, 0xf3f0ea, 0xd3cdc0}};

// Builds a piece and moves it from where it was made to its place.
template <class Piece>
void put(Furnisher& f, const Place& place, const Piece& add_piece) {
  const std::size_t first = f.count();
  add_piece(f);
  move_group(f.out, first, f.count(), place);
}

// Puts the same piece, with the same materials, at several places.
template <class Piece>
void put_copies(Furnisher& f, const std::vector<Place>& places, const Piece& add_piece) {
  const std::size_t first = f.count();
  add_piece(f);
  const std::size_t last = f.count();
  for (std::size_t i = 1; i < places.size(); ++i) copy_group(f.out, first, last, places[i]);
  move_group(f.out, first, last, places.front());
}

// Returns the place of a piece whose back was made with its middle at `from`, for the wall
// `made_for` in the order of Side.
Place to_wall(const Vector2d& from, Side made_for, const Area& area, Side side, double along) {
  return {from, at_wall(area, side, along), static_cast<int>(side) - static_cast<int>(made_for)};
}

// The same for a piece of world_pieces.h.
Place to_wall(const Area& area, Side side, double along) {
  return to_wall(Vector2d::Zero(), Side::kNorth, area, side, along);
}

const Vector2d kBookshelfBack(-1.5, 1.9), kSideboardBack(0.15, 1.9), kSofaBack(2.4, -0.1),
    kDeskBack(-0.5, -1.9), kDoorBack(1.41, -1.9);
const Vector2d kPlantFoot(-2.0, 0.95), kLampFoot(1.35, 1.45);

void furnish_living_room(Furnisher& f, const Area& area) {
  put(f, to_wall(kBookshelfBack, Side::kNorth, area, Side::kNorth, -4.1), add_bookshelf);
  put(f, to_wall(kSideboardBack, Side::kNorth, area, Side::kNorth, -2.5), add_sideboard);
  put(f, to_wall(kSofaBack, Side::kEast, area, Side::kWest, 0.85), add_sofa);
  put(f, to_wall(kSofaBack, Side::kEast, area, Side::kWest, 0.85), add_window);
  put(f, to_wall(kDeskBack, Side::kSouth, area, Side::kSouth, -2.1), add_desk);
  put(f, {kPlantFoot, {-5.2, 2.2}, 0}, add_plant);
  put(f, {kLampFoot, {-1.35, 2.25}, 0}, add_floor_lamp);
  add_chair(f, -2.1, -0.35, 170);
  add_chair(f, -0.55, 2.1, 150);
  const int frame = f.material(Pattern::kWood, 0x2c2622, 0x15110e);
  add_painting(f, area, Side::kEast,
               {0.0, 1.55, 0.75, 0.6, frame, f.material(Pattern::kLandscape, 0x7a8a4a, 0x3f5f3a)});
  f.box({-3.4, -1.2}, {0.45, 1.75}, {-kSunk_m, 0.014},
        f.material(Pattern::kRug, 0xa33b35, 0x27425f));
}

void furnish_bedroom(Furnisher& f, const Area& area) {
  put(f, to_wall(area, Side::kNorth, 4.95), add_bed);
  put(f, to_wall(area, Side::kNorth, 0.8), add_wardrobe);
  put(f, to_wall(area, Side::kNorth, 2.7), add_dresser);
  put(f, to_wall(area, Side::kEast, -0.3), add_radiator);
  put(f, {Vector2d::Zero(), {1.7, -0.35}, 1}, add_coffee_table);
  put(f, to_wall(kSofaBack, Side::kEast, area, Side::kEast, -0.3), add_window);
  add_chair(f, 0.75, -0.5, -80);
  const int frame = f.material(Pattern::kWood, 0xe8e0d0, 0xc9bda6);
  add_painting(f, area, Side::kNorth,
               {2.7, 1.55, 0.9, 0.7, frame, f.material(Pattern::kRings, 0xc94f3a, 0x2b5e7d)});
  add_painting(f, area, Side::kSouth,
               {1.7, 1.6, 1.1, 0.7, frame, f.material(Pattern::kMosaic, 0x2f7f86, 0xc8543a)});
  add_painting(f, area, Side::kWest,
               {0.0, 1.6, 0.6, 0.8, frame, f.material(Pattern::kLandscape, 0x8a7a4a, 0x3f4f3a)});
  add_painting(f, area, Side::kWest,
               {2.2, 1.5, 0.4, 0.5, frame, f.material(Pattern::kRings, 0x4a7a3a, 0xd0a040)});
  f.box({2.3, 3.9}, {0.2, 1.4}, {-kSunk_m, 0.014}, f.material(Pattern::kRug, 0x4a6a5a, 0xd0b070));
}

void furnish_hall(Furnisher& f, const Area& area) {
  put(f, to_wall(area, Side::kSouth, -2.0), add_coats);
  put(f, to_wall(area, Side::kSouth, 1.8), add_radiator);
  put(f, to_wall(kDoorBack, Side::kSouth, area, Side::kSouth, -0.4), add_door);
  const int frame = f.material(Pattern::kWood, 0x6a4526, 0x3c2412),
            red = f.material(Pattern::kMetal, 0xd03a2a, 0x8a2018);
  add_painting(f, area, Side::kSouth,
               {-3.2, 1.4, 0.7, 0.9, frame, f.material(Pattern::kMosaic, 0x8a3f55, 0x3f7f86)});
  add_painting(f, area, Side::kSouth,
               {1.8, 1.4, 0.9, 0.6, frame, f.material(Pattern::kLandscape, 0x6b8f5a, 0x2c4a3a)});
  add_painting(f, area, Side::kSouth,
               {3.1, 1.35, 0.5, 0.7, frame, f.material(Pattern::kRings, 0xd8b04a, 0x2f5a78)});
  add_painting(f, area, Side::kSouth,
               {4.2, 1.4, 0.6, 0.6, frame, f.material(Pattern::kMosaic, 0x2f5f86, 0xd0683a)});
  add_painting(f, area, Side::kNorth,
               {-1.6, 1.5, 1.0, 0.7, frame, f.material(Pattern::kLandscape, 0xa88a4a, 0x5f4f2a)});
  add_painting(f, area, Side::kNorth,
               {1.2, 1.5, 0.6, 0.8, frame, f.material(Pattern::kRings, 0xa03a5a, 0x3a7a8a)});
  add_painting(f, area, Side::kEast,
               {-1.76, 1.4, 0.7, 0.9, frame, f.material(Pattern::kMosaic, 0xc06a2a, 0x2a5a4a)});
  f.column(0.75, area.y.low + 0.09, {-kSunk_m, 0.5}, 0.07, red);
  f.sphere({0.75, area.y.low + 0.09, 0.52}, 0.06, red);
  f.box({-3.4, 3.4}, {-2.1, -1.42}, {-kSunk_m, 0.014},
        f.material(Pattern::kRug, 0x6a2f3a, 0xc8a868));
}

void furnish_twin(Furnisher& f, const Area& area) {
  put(f, to_wall(kSideboardBack, Side::kNorth, area, Side::kNorth, -4.3), add_sideboard);
  put(f, to_wall(kBookshelfBack, Side::kNorth, area, Side::kWest, 0.55), add_bookshelf);
  put(f, to_wall(kDeskBack, Side::kSouth, area, Side::kSouth, -4.3), add_desk);
  put(f, {kPlantFoot, {-2.6, -0.95}, 0}, add_plant);
  put(f, {kLampFoot, {-5.75, 1.85}, 0}, add_floor_lamp);
  add_chair(f, -2.65, 1.7, 150);
  const int frame = f.material(Pattern::kWood, 0x6a4526, 0x3c2412);
  add_painting(f, area, Side::kEast,
               {1.1, 1.5, 0.6, 0.8, frame, f.material(Pattern::kMosaic, 0x2f5f86, 0xd0683a)});
  add_painting(f, area, Side::kWest,
               {-0.7, 1.5, 0.6, 0.5, frame, f.material(Pattern::kRings, 0xc94f3a, 0x2b5e7d)});
  f.box({-5.2, -3.2}, {-0.1, 1.2}, {-kSunk_m, 0.014},
        f.material(Pattern::kRug, 0xa33b35, 0x27425f));
}

void furnish_passage(Furnisher& f, const Area& area) {
  const int frame = f.material(Pattern::kWood, 0x2c2622, 0x15110e);
  add_painting(f, area, Side::kSouth,
               {-0.9, 1.45, 0.9, 0.7, frame, f.material(Pattern::kLandscape, 0x6b8f5a, 0x2c4a3a)});
  put(f, to_wall(area, Side::kSouth, 0.7), add_radiator);
  put(f, to_wall(area, Side::kNorth, 1.0), add_coats);
  add_painting(f, area, Side::kNorth,
               {-0.6, 1.4, 0.6, 0.8, frame, f.material(Pattern::kMosaic, 0x8a3f55, 0x3f7f86)});
  f.box({-1.7, 1.3}, {-0.35, 0.35}, {-kSunk_m, 0.014},
        f.material(Pattern::kRug, 0x2f4f6a, 0xc8a868));
}

// The only objects that distinguish the two ends of the row.
void furnish_office_ends(Furnisher& f, const Area& area) {
  const int frame = f.material(Pattern::kMetal, 0x8a8c90, 0x5a5c60);
  add_painting(f, area, Side::kEast,
               {0.2, 1.45, 1.6, 1.0, frame, f.material(Pattern::kScreen, 0xe8e8e4, 0x2f5a9a)});
  put(f, to_wall(area, Side::kEast, -1.2), add_dresser);
  put(f, {kPlantFoot, {5.0, 1.6}, 0}, add_plant);
  put(f, to_wall(kSofaBack, Side::kEast, area, Side::kWest, 0.0), add_window);
  put(f, to_wall(area, Side::kWest, 0.0), add_radiator);
  add_painting(f, area, Side::kWest,
               {-1.6, 1.5, 0.7, 0.9, frame, f.material(Pattern::kMosaic, 0xd0683a, 0x2f5f86)});
  f.sphere({-1.4, -0.35, 0.745 + 0.11}, 0.11, f.material(Pattern::kRings, 0xe0a030, 0x8f2f45));
}

}  // namespace

void furnish_loop(Furnisher& f) {
  const Area living{{-5.6, -0.06}, {-1.0, 2.6}}, bedroom{{0.06, 5.6}, {-1.0, 2.6}},
      hall{{-5.6, 5.6}, {-2.4, -1.12}};
  add_shell(f, {living, bedroom, hall}, kHomeShell);
  const int white = f.material(Pattern::kWood, 0xf2ede2, 0xd9d0bf);
  const int cream = f.material(Pattern::kPlaster, 0xe9e0cf, 0xc4b496),
            teal = f.material(Pattern::kPlaster, 0x6f98a4, 0x456f80);
  const int paper = f.material(Pattern::kWallpaper, 0xe7dcc6, 0x8f9f86),
            rose = f.material(Pattern::kPlaster, 0xd0a89c, 0xa87868);
  const int green = f.material(Pattern::kPlaster, 0xa8b08c, 0x78845c),
            sand = f.material(Pattern::kPlaster, 0xd8c8a8, 0xa89068);
  const int oak = f.material(Pattern::kPlanks, 0xc99a62, 0x8a5a30),
            walnut = f.material(Pattern::kPlanks, 0x8a6040, 0x54351c);
  const int tiles = f.material(Pattern::kTiles, 0xc8c0b0, 0x8a8478);
  add_area(f, living, {{cream, paper, teal, cream}, oak, white},
           {{Side::kSouth, -4.0}, {Side::kEast, 1.2}});
  add_area(f, bedroom, {{rose, green, rose, green}, walnut, white},
           {{Side::kSouth, 4.0}, {Side::kWest, 1.2}});
  add_area(f, hall, {{sand, sand, sand, sand}, tiles, white},
           {{Side::kNorth, -4.0}, {Side::kNorth, 4.0}});
  light_area(f, living, Side::kWest);
  light_area(f, bedroom, Side::kEast);
  light_area(f, hall, Side::kSouth);
  furnish_living_room(f, living);
  furnish_bedroom(f, bedroom);
  furnish_hall(f, hall);
}

void furnish_twins(Furnisher& f) {
  // Half the plan's length and width are whole multiples of half a cell of the light's grid, so
  // that the grid is its own copy as well.
  const Area room{{-6.10, -2.12}, {-1.4, 2.18}}, copy{{2.12, 6.10}, {-2.18, 1.4}},
      passage{{-2.0, 2.0}, {-0.65, 0.65}};
  add_shell(f, {room, copy, passage}, kHomeShell);
  const int white = f.material(Pattern::kWood, 0xf2ede2, 0xd9d0bf),
            oak = f.material(Pattern::kPlanks, 0xc99a62, 0x8a5a30);
  const int cream = f.material(Pattern::kPlaster, 0xe9e0cf, 0xc4b496),
            teal = f.material(Pattern::kPlaster, 0x6f98a4, 0x456f80);
  const int sand = f.material(Pattern::kPlaster, 0xd8c8a8, 0xa89068),
            tiles = f.material(Pattern::kTiles, 0xc8c0b0, 0x8a8478);
  const std::size_t first = f.count();
  add_area(f, room, {{cream, teal, cream, teal}, oak, white}, {{Side::kEast, 0.0}});
  furnish_twin(f, room);
  copy_group(f.out, first, f.count(), {Vector2d::Zero(), Vector2d::Zero(), 2});
  add_area(f, passage, {{sand, sand, sand, sand}, tiles, white},
           {{Side::kWest, 0.0}, {Side::kEast, 0.0}});
  furnish_passage(f, passage);
  light_area(f, room, Side::kWest);
  light_area(f, copy, Side::kEast);
  light_area(f, passage, Side::kSouth);
}

void furnish_office(Furnisher& f) {
  const Area hall{{-5.4, 5.4}, {-2.4, 2.4}};
  add_shell(f, {hall},
            {{Pattern::kPlaster, 0xe2e0d8, 0xc4c0b4},
             {Pattern::kTiles, 0xa8aab0, 0x83868e},
             {Pattern::kPlaster, 0xf3f0ea, 0xd3cdc0}});
  const int white = f.material(Pattern::kPlaster, 0xe2e0d8, 0xc4c0b4),
            trim = f.material(Pattern::kWood, 0x8a8680, 0x605c58);
  const int carpet = f.material(Pattern::kFabric, 0x5a6470, 0x465060);
  add_area(f, hall, {{white, white, white, white}, carpet, trim}, {});
  const int cloth = f.material(Pattern::kFabric, 0x4a6a8a, 0x34506c),
            screen = f.material(Pattern::kScreen, 0x1c2733, 0x7fd0c0, 0.5f);
  std::vector<Place> workplaces, racks;
  for (const double x : {-2.85, -0.95, 0.95, 2.85}) {
    // Screens are placed back to back without intersecting.
    workplaces.push_back({Vector2d::Zero(), {x, -0.05}, 0});
    workplaces.push_back({Vector2d::Zero(), {x, 0.05}, 2});
    racks.push_back(to_wall(hall, Side::kNorth, x));
    racks.push_back(to_wall(hall, Side::kSouth, x));
  }
  put_copies(f, workplaces, [&](Furnisher& g) { add_workplace(g, cloth, screen); });
  put_copies(f, racks, add_rack);
  furnish_office_ends(f, hall);
  light_area(f, hall, Side::kEast);
}

void furnish_blank(Furnisher& f) {
  constexpr double kHalfLength = 3.6, kHalfWidth = 2.6, kCorridor = 1.5;
  const Area plan{{-kHalfLength, kHalfLength}, {-kHalfWidth, kHalfWidth}};
  const Paint paint{Pattern::kPaint, 0xdcd8ce, 0xd2cec4}, lino{Pattern::kPaint, 0x9a9a92, 0x8a8a84};
  add_shell(f, {plan}, {paint, lino, {Pattern::kPaint, 0xf0eee8, 0xe8e6e0}});
  const int wall = f.material(Pattern::kPaint, 0xdcd8ce, 0xd2cec4),
            floor = f.material(Pattern::kPaint, 0x9a9a92, 0x8a8a84);
  const int trim = f.material(Pattern::kWood, 0x7a7670, 0x605c58);
  add_area(f, plan, {{wall, wall, wall, wall}, floor, trim}, {});
  const double x = kHalfLength - kCorridor, y = kHalfWidth - kCorridor, skirting = kSkirting_m,
               thick = 0.016;
  f.box({-x, x}, {-y, y}, {-kSunk_m, kRoomHeight_m + kSunk_m}, wall);
  f.box({-x - thick, x + thick}, {-y - thick, y + thick}, {-kSunk_m, skirting}, trim);
  put(f, to_wall(kDoorBack, Side::kSouth, plan, Side::kNorth, 1.2), add_door);
  put(f, to_wall(kDoorBack, Side::kSouth, plan, Side::kWest, -0.4), add_door);
  put(f, to_wall(plan, Side::kSouth, -1.5), add_radiator);
  put_copies(f,
             {to_wall(plan, Side::kSouth, 1.2), to_wall(plan, Side::kEast, 0.4),
              to_wall(plan, Side::kNorth, -1.6)},
             add_sconce);
  // A grille beside one corner; the opposite corner has none.
  on_wall(f, {plan, Side::kEast}, {{-1.30, -1.02}, {-kSunk_m, 0.02}, {0.24, 0.40}},
          f.material(Pattern::kTiles, 0xc8c8c4, 0x9a9a98));
  // One tube for each leg of the corridor: they meet in the corners, so that the light is
  // continuous.
  light_area(f, {plan.x, {y, kHalfWidth}}, Side::kNorth);
  light_area(f, {plan.x, {-kHalfWidth, -y}}, Side::kSouth);
  light_area(f, {{-kHalfLength, -x}, plan.y}, Side::kWest);
  light_area(f, {{x, kHalfLength}, plan.y}, Side::kEast);
}

void furnish_turntable(Furnisher& f) {
  const Area room{{-2.0, 2.0}, {-1.6, 1.0}};
  add_shell(f, {room}, kHomeShell);
  const int white = f.material(Pattern::kWood, 0xf2ede2, 0xd9d0bf),
            oak = f.material(Pattern::kPlanks, 0xc99a62, 0x8a5a30);
  const int cream = f.material(Pattern::kPlaster, 0xe9e0cf, 0xc4b496),
            paper = f.material(Pattern::kWallpaper, 0xe7dcc6, 0x8f9f86);
  add_area(f, room, {{paper, cream, cream, cream}, oak, white}, {});
  light_area(f, room, Side::kWest);
  const int frame = f.material(Pattern::kWood, 0x6a4526, 0x3c2412);
  add_painting(f, room, Side::kNorth,
               {-0.45, 1.15, 0.5, 0.4, frame, f.material(Pattern::kMosaic, 0x2f5f86, 0xd0683a)});
  const int wood = f.material(Pattern::kWood, 0xb98754, 0x7d5026);
  f.box({-0.6, 0.6}, {-0.4, 0.45}, {0.72, 0.75}, wood);
  for (const double x : {-0.55, 0.55})
    for (const double y : {-0.35, 0.40}) f.column(x, y, {-kSunk_m, 0.73}, 0.02, wood);

  const std::size_t first = f.count();
  const int glaze = f.material(Pattern::kCeramic, 0x2f6f83, 0xe8e0cf),
            tiles = f.material(Pattern::kTiles, 0xe4d8c0, 0x9c5a44);
  f.column(0, 0, {0.74, 0.77}, 0.25, f.material(Pattern::kRug, 0x4a6a5a, 0xd0b070));
  turn(f.box({-0.13, 0.05}, {-0.12, 0.02}, {0.75, 0.90}, tiles), 20, Eigen::Vector3d::UnitZ());
  f.column(0.12, 0.06, {0.75, 1.02}, 0.055, glaze);
  f.torus({0.12, 0.06, 1.02}, 0.047, 0.014, glaze);
  f.sphere({-0.06, -0.06, 0.96}, 0.075, f.material(Pattern::kMosaic, 0x8a3f55, 0x3f7f86));
  Shape& ring =
      f.torus({-0.10, 0.12, 0.865}, 0.08, 0.025, f.material(Pattern::kRings, 0xe0a030, 0x8f2f45));
  turn(ring, 90, Eigen::Vector3d::UnitX());
  turn(ring, 35, Eigen::Vector3d::UnitZ());
  turn(f.box({0.06, 0.20}, {-0.17, -0.07}, {0.75, 0.80},
             f.material(Pattern::kBook, 0x2f6a7a, 0xf0dfae)),
       -15, Eigen::Vector3d::UnitZ());
  f.out.turning_count = f.count() - first;
}

void furnish_poster(Furnisher& f) {
  const Area room{{-1.6, 1.6}, {-1.4, kPosterWall_m}};
  add_shell(f, {room}, kHomeShell);
  const int white = f.material(Pattern::kWood, 0xf2ede2, 0xd9d0bf),
            oak = f.material(Pattern::kPlanks, 0xc99a62, 0x8a5a30);
  const int cream = f.material(Pattern::kPlaster, 0xe9e0cf, 0xc4b496),
            paper = f.material(Pattern::kWallpaper, 0xe7dcc6, 0x8f9f86);
  add_area(f, room, {{paper, cream, cream, cream}, oak, white}, {});
  light_area(f, room, Side::kWest);
  const int frame = f.material(Pattern::kWood, 0x6a4526, 0x3c2412),
            words = f.material(Pattern::kLetters, 0xe4e0d4, 0x202428);
  add_painting(f, room, Side::kNorth, {0, kPosterHeight_m, 0.9, 0.66, frame, words});
  const int wood = f.material(Pattern::kWood, 0xb98754, 0x7d5026),
            glaze = f.material(Pattern::kCeramic, 0x2f6f83, 0xe8e0cf);
  on_wall(f, {room, Side::kNorth}, {{-0.7, 0.7}, {-kSunk_m, 0.18}, {0.98, 1.00}}, wood);
  f.column(-0.35, 0.90, {0.99, 1.09}, 0.04, glaze);
  f.sphere({0.12, 0.90, 1.045}, 0.05, f.material(Pattern::kMosaic, 0x8a3f55, 0x3f7f86));
  turn(f.box({0.34, 0.46}, {0.85, 0.95}, {0.99, 1.07},
             f.material(Pattern::kTiles, 0xe4d8c0, 0x9c5a44)),
       20, Eigen::Vector3d::UnitZ());
  f.column(0.66, 0.97, {-kSunk_m, kRoomHeight_m}, 0.05,
           f.material(Pattern::kTiles, 0xc8c0b0, 0x8a8478));
}

}  // namespace hermite::synthetic
