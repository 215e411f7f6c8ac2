// The interface of a depth camera attached to this machine, as the scanning client uses it. For the
// kinds of camera see camera_kinds.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::client {

struct CameraDescription {
  std::string name;  // display name: "Kinect v1 (1)"
  Camera camera;     // intrinsics of the frames
  // Origin of the intrinsics: "nominal for every Kinect v1", "the device", "camera.json".
  std::string camera_source;
  double frame_rate_hz = 30;  // nominal
};

struct LeftOut {
  std::uint64_t unpaired = 0;  // depth images without a simultaneous colour image
};

// Captures from its construction until its destruction. All functions are called on one thread,
// which should call next() again within a few frames: images that are not fetched are dropped, the
// oldest first.
class CaptureCamera {
 public:
  virtual ~CaptureCamera() = default;
  virtual const CameraDescription& description() const = 0;

  // Returns the next frame: depth and colour of the same moment in the size of the camera, with
  // timestamps in seconds from an arbitrary start, strictly ascending. std::nullopt: no frame
  // within `patience`. kNotFound: there will be no more (end of a recording). kDevice, with a
  // message: unplugged or broken.
  virtual Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) = 0;

  virtual LeftOut left_out() const { return {}; }  // so far
};

}  // namespace hermite::client
