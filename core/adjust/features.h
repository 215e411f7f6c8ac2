// ORB key points with depth: corners over eight scales, spread over the image, with a 256-bit descriptor each (Rublee et al. 2011).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/adjust/descriptor.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

inline constexpr double kOctaveScale = 1.2;  // of one octave to the next
inline constexpr int kOctaveCount = 8;
// Depth that is used: nearer the sensor is blind, and beyond 5 m its noise (bundle_noise.h) passes 7 cm.
inline constexpr double kMinFeatureDepth_m = 0.3;
inline constexpr double kMaxFeatureDepth_m = 5.0;

struct Feature {
  Eigen::Vector2f pixel_px = Eigen::Vector2f::Zero();  // in the full image, pixel centres are integers
  float depth_m = 0;                                   // 0: none that could be trusted
  std::uint8_t octave = 0;                             // found in the image scaled down by kOctaveScale^octave
  float angle_rad = 0;                                 // of the brighter side, from x towards y, -pi to pi
  Descriptor descriptor{};
};

// A side of a feature's pixel in the full image: 1.2^octave. Also the standard deviation of its position, as the authors' program has it.
double octave_scale(int octave);

struct FeatureOptions {
  // For 640x480; other sizes get as many for their side lengths (320x240: 500), never above kMaxFeatureCount. A quarter, as the area has,
  // finds three of four places that a half finds (measured on redkitchen).
  int feature_count = 1000;
};
inline constexpr int kMaxFeatureCount = 2000;

// `frame` is rectified and of the camera's size. At most the stated count, fewer in images without texture, by ascending octave, in rows
// and columns of cells within it. The same frame gives the same features. Thread-safe.
std::vector<Feature> detect_features(const RgbdFrame& frame, const Camera& camera, const FeatureOptions& options = {});

// Depth [m] at the key point: the median of the 3x3 pixels around it; 0 where fewer than five of them have depth, where they span more than
// noise and a slope of 60 degrees explain (the key point is on a depth edge), outside the trusted range or outside the image.
float depth_at(const DepthImage& depth, const Camera& camera, const Eigen::Vector2f& pixel_px);

}  // namespace hermite
