// The door of a frame: straightens the images of distorted lenses, corrects depth and brings colour into the depth camera, so that
// everything behind can take the camera for one pinhole with registered images, rectified(camera).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame/color_registration.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

// Where depth is registered to colour (no Camera::color), both images came through one lens and are straightened alike. Else depth is
// straightened by the distortion of its camera, and colour, looked up for the straight depth, by that of its own. Depth is corrected
// (Camera::depth_correction) once it is straight, rounded to the sensor's units.
// Const functions are thread-safe.
class Rectifier {
 public:
  explicit Rectifier(const Camera& camera);

  // Depth of the nearest pixel, colour between four; no depth and black beyond the image. The frame has the camera's size.
  RgbdFrame apply(const RgbdFrame& frame) const;

 private:
  // Where a pixel of the straight images lies in the distorted ones.
  struct Source {
    float x = 0, y = 0;         // pixels
    std::int32_t nearest = -1;  // index of the pixel nearest to it; -1: outside
  };
  DepthImage straight(const DepthImage& depth) const;
  ColorImage straight(const ColorImage& color) const;
  void correct(DepthImage& depth) const;

  const Camera camera_;

  std::vector<Source> sources_;  // empty: they are straight as they arrive
  std::optional<ColorRegistration> registration_;
};

// None for a camera whose frames are right as they arrive.
std::optional<Rectifier> rectifier_of(const Camera& camera);

}  // namespace hermite
