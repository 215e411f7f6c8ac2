// Rigid transforms as the shaders read them.
#pragma once

#include "core/math/rigid3.h"
#include "shaders/shared/types.h"

namespace hermite::frame {

// Pure, any thread.
inline shared::Transform to_shared(const Rigid3& target_from_source) {
  const Eigen::Matrix<float, 3, 4> m = target_from_source.matrix().topRows<3>().cast<float>();
  const auto row = [&m](int i) { return shared::vec4{m(i, 0), m(i, 1), m(i, 2), m(i, 3)}; };
  return {row(0), row(1), row(2)};
}

}  // namespace hermite::frame
