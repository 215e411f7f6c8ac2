#include "core/mesh/surfel_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::mesh {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::uint32_t> slots_in(const SurfelGrid& grid, const Eigen::Vector3f& low_m,
                                    const Eigen::Vector3f& high_m) {
  std::vector<std::uint32_t> slots;
  grid.for_each(low_m, high_m, [&slots](std::uint32_t slot) { slots.push_back(slot); });
  return slots;
}

TEST(SurfelGrid, TellsWhatIsInTheBinsOfABoxByPlaceAndThenBySlot) {
  SurfelGrid grid(0.01);  // bins of 4 cm
  grid.insert(7, {0.05f, 0.01f, 0.01f});
  grid.insert(5, {-0.01f, 0.01f, 0.01f});
  grid.insert(3, {0.06f, 0.01f, 0.01f});
  grid.insert(9, {0.01f, 0.01f, 0.05f});
  EXPECT_THAT(slots_in(grid, {-0.01f, 0, 0}, {0.05f, 0.01f, 0.05f}), ElementsAre(5, 3, 7, 9));
  EXPECT_THAT(slots_in(grid, {0.01f, 0, 0}, {0.02f, 0.01f, 0.01f}), IsEmpty());
  grid.remove(3, {0.06f, 0.01f, 0.01f});
  EXPECT_THAT(slots_in(grid, {0.05f, 0, 0}, {0.05f, 0, 0}), ElementsAre(7));
}

}  // namespace
}  // namespace hermite::mesh
