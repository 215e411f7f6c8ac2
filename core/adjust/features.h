// ORB keypoints with depth: corners over eight octaves, spread over the image, with a 256-bit
// descriptor each (Rublee et al. 2011).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/adjust/descriptor.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::adjust {

inline constexpr double kOctaveScale = 1.2;  // scale of one octave relative to the one before
inline constexpr int kOctaveCount = 8;
// The trusted depth range: nearer, the sensor is blind; beyond 5 m its noise (bundle_noise.h)
// exceeds 7 cm.
inline constexpr double kMinFeatureDepth_m = 0.3;
inline constexpr double kMaxFeatureDepth_m = 5.0;

struct Feature {
  // In the full image; pixel centres are integers.
  Eigen::Vector2f pixel_px = Eigen::Vector2f::Zero();
  float depth_m = 0;  // 0: no reliable depth
  // Detected in the image scaled down by kOctaveScale^octave.
  std::uint8_t octave = 0;
  // Direction of the brighter side, from x towards y, -pi to pi.
  float angle_rad = 0;
  Descriptor descriptor{};
};

// Returns the side length of a feature's pixel in the full image, 1.2^octave. As in the authors'
// program, this is also the standard deviation of its position.
double octave_scale(int octave);

struct FeatureOptions {
  // The count for 640x480. Other sizes get a count in proportion to their side lengths (320x240:
  // 500), at most kMaxFeatureCount. In proportion to the area (a quarter), only three of the four
  // places are recognised that half the features recognise (measured on redkitchen).
  int feature_count = 1000;
};
inline constexpr int kMaxFeatureCount = 2000;

// Detects at most the stated number of features, fewer in images without texture, ordered by
// octave, then by rows and columns of cells. `frame` is rectified and has the camera's size. The
// same frame gives the same features. Thread-safe.
std::vector<Feature> detect_features(const frame::RgbdFrame& frame, const Camera& camera,
                                     const FeatureOptions& options = {});

// Returns the depth [m] at a keypoint: the median of the 3x3 pixels around it. Returns 0 if fewer
// than five of them have depth, if they span more than noise and a slope of 60 degrees explain (the
// keypoint is on a depth edge), or if it is outside the trusted range or the image.
float depth_at(const DepthImage& depth, const Camera& camera, const Eigen::Vector2f& pixel_px);

}  // namespace hermite::adjust
