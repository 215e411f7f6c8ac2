// A depth camera that is attached to this machine: what the scanning client asks of any kind. Kinds: camera_kinds.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

struct CameraDescription {
  std::string name;           // for a person: "Kinect v1 (1)"
  Camera camera;              // of the frames that come
  std::string camera_source;  // "nominal for every Kinect v1", "the device", "camera.json"
  double frame_rate_hz = 30;  // nominal
};

struct LeftOut {
  std::uint64_t unpaired = 0;  // depth images without a colour image at the same time
};

// Runs from when it was opened until it is destroyed. Everything from one thread, which should ask again within some frames: what nobody
// fetches is lost, the newest last.
class CaptureCamera {
 public:
  virtual ~CaptureCamera() = default;
  virtual const CameraDescription& description() const = 0;

  // The next frame of the camera's size, depth and colour of the same moment, times in seconds from any start, strictly ascending.
  // None: nothing came within `patience`. kNotFound: there will be no more (the end of a recording). kDevice, in words: unplugged or
  // broken.
  virtual Result<std::optional<RgbdFrame>> next(std::chrono::milliseconds patience) = 0;

  virtual LeftOut left_out() const { return {}; }  // so far
};

}  // namespace hermite
