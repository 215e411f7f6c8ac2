// Straightens the images of a distorted lens, so that everything behind can take the camera for a pinhole.
#pragma once

#include <vector>

#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

// Where every pixel of the straight images lies in the distorted ones. Const functions are thread-safe.
class Undistorter {
 public:
  explicit Undistorter(const Camera& camera);

  // Depth of the nearest pixel, colour between four; no depth and black beyond the image. The frame has the camera's size.
  RgbdFrame apply(const RgbdFrame& frame) const;

 private:
  struct Source {
    float x = 0, y = 0;  // pixels
  };
  std::vector<Source> sources_;
};

}  // namespace hermite
