// What is done with a frame before its turn on the device, for one camera. Const functions are thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "core/frame/prepared_frame.h"
#include "core/frame/rectify.h"
#include "core/math/camera.h"
#include "core/pipeline/options.h"

namespace hermite {

class FramePreparer {
 public:
  // `number` tells the cameras of one pipeline apart.
  FramePreparer(const Camera& camera, const Options& options, std::uint32_t number);

  const Camera& camera() const { return camera_; }
  std::uint32_t number() const { return number_; }

  // kInvalidArgument: of another size than the camera's.
  Status check(const RgbdFrame& frame) const;

  // Straightened and registered, with what can be seen in it. The frame has the camera's size.
  PreparedFrame prepare(RgbdFrame frame) const;

  // One that was prepared for another camera.
  PreparedFrame prepare_again(const PreparedFrame& prepared) const;

  // That shows nothing.
  PreparedFrame empty(double timestamp_s) const;

 private:
  const Camera camera_;
  const Options options_;
  const std::uint32_t number_;
  const std::optional<Rectifier> rectifier_;  // when frames do not arrive straight and registered
};

}  // namespace hermite
