// Rectifies incoming frames: removes lens distortion, corrects depth, and registers colour to the
// depth camera. All further code can assume one pinhole with registered images, rectified(camera).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame/color_registration.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::frame {

// If depth is registered to colour (no Camera::color), both images have the same lens and are
// rectified alike. Otherwise depth is rectified with its camera's distortion, and colour is sampled
// at the rectified depth's points with its own distortion. Depth is corrected
// (Camera::depth_correction) after rectification and rounded to sensor units. Const functions are
// thread-safe.
class Rectifier {
 public:
  explicit Rectifier(const Camera& camera);

  // Takes depth (core/math/depth_between.h) and colour between four pixels; outside the image,
  // depth is 0, and colour continues the border. The frame has the camera's size.
  RgbdFrame apply(const RgbdFrame& frame) const;

 private:
  // Position of a rectified pixel in the distorted image.
  struct Source {
    float x = 0, y = 0;  // pixels
  };
  DepthImage straight(const DepthImage& depth) const;
  ColorImage straight(const ColorImage& color) const;
  void correct(DepthImage& depth) const;

  const Camera camera_;

  std::vector<Source> sources_;  // empty: the images need no rectification
  std::optional<ColorRegistration> registration_;
};

// Returns nullopt for a camera whose frames need no processing.
std::optional<Rectifier> rectifier_of(const Camera& camera);

}  // namespace hermite::frame
