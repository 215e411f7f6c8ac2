// Serialises a feature in our own byte format (core/base/byte_stream.h).
#pragma once

#include <cmath>

#include "core/adjust/features.h"
#include "core/base/byte_stream.h"
#include "core/math/camera.h"

namespace hermite::adjust {

template <class Bytes, class Saved>
void feature_fields(Bytes& bytes, Saved& feature) {
  bytes.numbers(feature.pixel_px.data(), 2);
  bytes.number(feature.depth_m);
  bytes.number(feature.octave);
  bytes.number(feature.angle_rad);
  bytes.number(feature.descriptor);
  bytes.require(feature.pixel_px.allFinite() &&
                    feature.pixel_px.cwiseAbs().maxCoeff() <= 2 * kMaxImageSide_px &&
                    feature.depth_m >= 0 &&
                    feature.depth_m <= static_cast<float>(kMaxFeatureDepth_m) &&
                    feature.octave < kOctaveCount && std::isfinite(feature.angle_rad),
                "a field of a feature is out of range");
}

}  // namespace hermite::adjust
