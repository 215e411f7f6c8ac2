// A rigid transform in the format of core/base/byte_stream.h: 56 bytes, exact.
#pragma once

#include <cmath>

#include "core/base/byte_stream.h"
#include "core/math/rigid3.h"

namespace hermite {

// Far beyond any scan, and small enough that sums and products of such transforms stay finite.
inline constexpr double kMaxStoredDistance_m = 1e6;
// Rotations are normalised after every product, so values farther from unit length are invalid.
inline constexpr double kStoredUnitTolerance = 1e-3;

template <class Bytes, class Transform>
void rigid3_fields(Bytes& bytes, Transform& transform) {
  bytes.numbers(transform.rotation.coeffs().data(), 4);
  bytes.numbers(transform.translation.data(), 3);
  // Written so that NaN fails as well.
  bytes.require(std::abs(transform.rotation.norm() - 1) < kStoredUnitTolerance &&
                    transform.translation.cwiseAbs().maxCoeff() <= kMaxStoredDistance_m &&
                    transform.translation.allFinite(),
                "a transform that is none");
}

}  // namespace hermite
