#include "core/measure/quantity.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/printf_text.h"

namespace hermite::measure {

const MeasureKindRow& row_of(MeasureKind kind) {
  const auto found = std::find_if(kMeasureKinds.begin(), kMeasureKinds.end(),
                                  [&](const MeasureKindRow& row) { return row.kind == kind; });
  CHECK(found != kMeasureKinds.end(), "every kind has its row");
  return *found;
}

std::optional<MeasureKind> measure_kind_of(std::string_view name) {
  for (const MeasureKindRow& row : kMeasureKinds)
    if (row.name == name) return row.kind;
  return std::nullopt;
}

std::string measure_kind_names() {
  std::string names;
  for (const MeasureKindRow& row : kMeasureKinds)
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  return names;
}

std::string text_of(const Quantity& quantity) {
  const bool is_angle = quantity.kind == MeasureKind::kAngle;
  const int decimals = is_angle ? 2 : 3;
  const char* unit = is_angle ? "°" : quantity.kind == MeasureKind::kArea ? " m²" : " m";
  const double last_digit = std::pow(10, -decimals);
  return printf_text("%.*f%s ± %.*f%s (%.0f %%)", decimals, quantity.value, unit, decimals,
                     std::ceil(quantity.half_width / last_digit) * last_digit, unit,
                     100 * kConfidence);
}

}  // namespace hermite::measure
