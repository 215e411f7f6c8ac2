#include "core/synthetic/room_builder.h"

#include <gtest/gtest.h>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

Furniture one_rod() {
  Furnisher f;
  f.rod({1, 0, 0}, {1.3, 0.4, 0}, 0.01, f.material(Pattern::kWood, 0x808080, 0x404040));
  return std::move(f.out);
}

TEST(RoomBuilder, QuarterTurnsAreExact) {
  Furniture furniture = one_rod();
  const Shape before = furniture.shapes[0];
  for (int i = 0; i < 4; ++i) move_group(furniture, 0, 1, {{0, 0}, {0, 0}, 1});
  EXPECT_EQ(furniture.shapes[0].center, before.center);
  EXPECT_EQ(furniture.shapes[0].world_from_shape, before.world_from_shape);
  move_group(furniture, 0, 1, {{0, 0}, {0, 0}, 1});
  EXPECT_EQ(furniture.shapes[0].center, Vector3d(-before.center.y(), before.center.x(), 0))
      << "counter-clockwise";
  move_group(furniture, 0, 1, {{0, 0}, {0, 0}, -1});
  EXPECT_EQ(furniture.shapes[0].center, before.center) << "negative turns go back";
}

TEST(RoomBuilder, AGroupGoesFromAPointToAPoint) {
  Furniture furniture = one_rod();
  move_group(furniture, 0, 1, {{1.15, 0.2}, {-4, 7}, 2});
  EXPECT_LT((furniture.shapes[0].center - Vector3d(-4, 7, 0)).norm(), 1e-12);
}

TEST(RoomBuilder, CopiesShareMaterialsAndLeaveTheOriginal) {
  Furniture furniture = one_rod();
  const Shape before = furniture.shapes[0];
  copy_group(furniture, 0, 1, {{0, 0}, {5, 0}, 0});
  ASSERT_EQ(furniture.shapes.size(), 2u);
  EXPECT_EQ(furniture.shapes[0].center, before.center);
  EXPECT_EQ(furniture.shapes[1].center, before.center + Vector3d(5, 0, 0));
  EXPECT_EQ(furniture.shapes[1].material, before.material);
  EXPECT_EQ(furniture.materials.size(), 1u);
}

TEST(RoomBuilder, MaterialsOfEqualColoursDiffer) {
  Furnisher f;
  f.material(Pattern::kWood, 0x808080, 0x404040);
  f.material(Pattern::kWood, 0x808080, 0x404040);
  EXPECT_NE(f.out.materials[0].seed, f.out.materials[1].seed);
}

}  // namespace
}  // namespace hermite::synthetic
