#include "core/synthetic/world_pieces.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/synthetic/room_pieces.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

struct Footprint {
  std::string name;
  std::function<void(Furnisher&)> add;
  // As the headers say; the back is at the wall, the front towards -y.
  double middle_x, back_y, width, depth;
};

// Everything a piece consists of lies where its header says, so that plans can be drawn from the
// headers. The corners of the bodies' boxes are compared: round bodies reach less far.
TEST(WorldPieces, StandWithinTheirFootprint) {
  const auto workplace = [](Furnisher& f) { add_workplace(f, 0, 0); };
  const Footprint pieces[] = {
      {"bed", add_bed, 0, 0, 1.0, 2.05},
      {"wardrobe", add_wardrobe, 0, 0, 1.2, 0.6},
      {"dresser", add_dresser, 0, 0, 1.15, 0.45},
      {"radiator", add_radiator, 0, 0, 0.92, 0.12},
      {"coats", add_coats, 0, 0, 1.0, 0.2},
      {"workplace", workplace, 0, 0, 1.6, 1.1},
      {"rack", add_rack, 0, 0, 1.32, 0.32},
      {"sconce", add_sconce, 0, 0, 0.2, 0.12},
      {"bookshelf", add_bookshelf, -1.5, 1.9, 1.2, 0.28},
      {"sideboard", add_sideboard, 0.15, 1.9, 1.48, 0.47},
  };
  for (const Footprint& piece : pieces) {
    Furnisher f;
    piece.add(f);
    ASSERT_GT(f.count(), 0u) << piece.name;
    for (const Shape& shape : f.out.shapes) {
      const Vector3d reach = shape.world_from_shape.cwiseAbs() * bounding_half_sides(shape);
      const Vector3d low = shape.center - reach, high = shape.center + reach;
      EXPECT_GE(low.x(), piece.middle_x - piece.width / 2 - 1e-9) << piece.name;
      EXPECT_LE(high.x(), piece.middle_x + piece.width / 2 + 1e-9) << piece.name;
      EXPECT_GE(low.y(), piece.back_y - piece.depth - 1e-9) << piece.name;
      EXPECT_LE(high.y(), piece.back_y + kSunk_m + 1e-9) << piece.name;
      EXPECT_GE(low.z(), -kSunk_m - 0.02)
          << piece.name << ": a slanted rod's box reaches a little further";
      EXPECT_LE(high.z(), 2.3) << piece.name;
    }
  }
}

}  // namespace
}  // namespace hermite::synthetic
