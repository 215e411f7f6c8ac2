// A cloud that is a square of a plane: the simplest that has a surface. Header only.
#pragma once

#include "core/output/cloud.h"

namespace hermite::test {

// `edge` by `edge` points, a centimetre from each other, seen from where the camera was.
inline output::Cloud plane_cloud(int edge) {
  output::Cloud cloud;
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      output::CloudPoint point;
      point.position_m = {0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 1};
      point.normal = {0, 0, -1};
      point.color = {200, 100, 50};
      point.confidence = 10;
      point.radius_m = 0.008f;
      cloud.push_back(point);
    }
  return cloud;
}

}  // namespace hermite::test
