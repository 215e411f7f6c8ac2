#include "core/measure/quantity.h"

#include <gtest/gtest.h>

namespace hermite::measure {
namespace quantity_test {

TEST(Quantity, TextRoundsTheHalfWidthUpAndHasTheUnit) {
  const auto text = [](MeasureKind kind, double value, double half_width) {
    return text_of(Quantity{kind, value, half_width, 0, 0, 0});
  };
  EXPECT_EQ(text(MeasureKind::kDistance, 1.2341, 0.0021), "1.234 m ± 0.003 m (95 %)");
  EXPECT_EQ(text(MeasureKind::kAngle, 89.949, 0.204), "89.95° ± 0.21° (95 %)");
  EXPECT_EQ(text(MeasureKind::kArea, 12.3456, 0.0101), "12.346 m² ± 0.011 m² (95 %)");
}

TEST(Quantity, EveryKindIsFoundByItsName) {
  for (const MeasureKindRow& row : kMeasureKinds) {
    EXPECT_EQ(measure_kind_of(row.name), row.kind);
    EXPECT_EQ(row_of(row.kind).name, row.name);
  }
  EXPECT_FALSE(measure_kind_of("weight").has_value());
  EXPECT_EQ(measure_kind_names(), "distance, plane, height, angle, area");
}

}  // namespace quantity_test
}  // namespace hermite::measure
