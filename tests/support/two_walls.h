// Surfels to measure between. Header only.
#pragma once

#include "core/output/cloud.h"

namespace hermite::test {

// Two walls, 1.5 m apart, before a camera at the origin that sees both.
inline output::Cloud two_walls() {
  output::Cloud cloud;
  for (const float z : {1.0f, 2.5f})
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j) {
        output::CloudPoint point;
        point.position_m = {0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), z};
        point.normal = {0, 0, -1};
        point.confidence = 5;
        cloud.push_back(point);
      }
  return cloud;
}

}  // namespace hermite::test
