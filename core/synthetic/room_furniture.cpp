#include "core/synthetic/room_furniture.h"

#include "core/synthetic/room_pieces.h"
#include "core/synthetic/world_plans.h"

namespace hermite::synthetic {
namespace {

void add_shell(Furnisher& f) {
  // In the order of the room's faces: -x, +x, -y, +y, floor, ceiling.
  f.material(Pattern::kWallpaper, 0xe7dcc6, 0x8f9f86);
  f.material(Pattern::kPlaster, 0xe9e0cf, 0xc4b496);
  f.material(Pattern::kPlaster, 0x6f98a4, 0x456f80);
  f.material(Pattern::kPlaster, 0xeadfca, 0xc8b28c);
  f.material(Pattern::kPlanks, 0xc99a62, 0x8a5a30);
  f.material(Pattern::kPlaster, 0xf3f0ea, 0xd3cdc0);
  f.add(ShapeKind::kRoom, {kHalfLength_m, kHalfWidth_m, kRoomHeight_m / 2},
        {0, 0, kRoomHeight_m / 2}, 0);
  const Eigen::Vector2f corner(static_cast<float>(kHalfLength_m), static_cast<float>(kHalfWidth_m));
  f.out.lights.push_back(
      {-corner, corner, {0.15f, -0.1f, 2.3f}, {0.15f, -0.1f, 2.3f}, {2.4f, -0.1f, 1.7f}});
}

void furnish_room(Furnisher& f) {
  add_trim(f);
  add_bookshelf(f);
  add_sideboard(f);
  const auto named = [&f](const char* name, const auto& add) {
    const std::size_t first = f.count();
    add();
    f.name(name, first);
  };
  named("lamp", [&] { add_floor_lamp(f); });
  named("sofa", [&] { add_sofa(f); });
  add_window(f);
  named("desk", [&] { add_desk(f); });
  named("chair", [&] { add_chair(f, -0.45, -1.12, 170); });
  named("chair", [&] { add_chair(f, 1.75, 1.10, 140); });
  named("door", [&] { add_door(f); });
  named("plant", [&] { add_plant(f); });
  add_west_wall(f);
  named("divider", [&] { add_divider(f); });
  named("table", [&] { add_coffee_table(f); });
  add_toys(f);
}

}  // namespace

Furniture furnish(RoomScene scene) {
  Furnisher f;
  switch (scene) {
    case RoomScene::kRoom:
      add_shell(f);
      furnish_room(f);
      break;
    case RoomScene::kBare: add_shell(f); break;
    case RoomScene::kLoop: furnish_loop(f); break;
    case RoomScene::kTwins: furnish_twins(f); break;
    case RoomScene::kOffice: furnish_office(f); break;
    case RoomScene::kBlank: furnish_blank(f); break;
    case RoomScene::kTurntable: furnish_turntable(f); break;
    case RoomScene::kPoster: furnish_poster(f); break;
  }
  return std::move(f.out);
}

int room_material_of_face(int face) { return face; }

}  // namespace hermite::synthetic
