// Does the camera of a scan fit what it sees? Asked while the scan goes on, from few views, and so warier than calibrate.h: of the focal
// length and the bend of depth alone, which lead a camera astray the most, and with an answer only where the views agree as well as those
// of a camera do that nothing else is wrong with.
//
// One thread at a time. Views are prepared and looked at on threads of their own; what comes of it depends on the frames alone.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/byte_stream.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

enum class CameraVerdict { kUnknown, kFits, kIsOff };

struct CameraCheck {
  CameraVerdict verdict = CameraVerdict::kUnknown;
  // Of a camera that is off, what makes it right: the logarithm of a factor of its focal length, and what is added to
  // DepthCorrection::bend. 0: not off in this way.
  double focal = 0, bend = 0;
};

inline Camera corrected(Camera camera, const CameraCheck& check) {
  camera.fx *= std::exp(check.focal);
  camera.fy *= std::exp(check.focal);
  camera.depth_correction.bend += check.bend;
  return camera;
}

// What is left of either in a camera that fits, as standard deviations: what was left of 1 % and 1.5 % after a correction by 12 to 16 views
// with the noise of a Kinect (tests/accuracy/README.md, "A camera that is wrong").
inline constexpr double kFittingFocal = 0.0015, kFittingBend = 0.001;

class CameraWatch {
 public:
  virtual ~CameraWatch() = default;

  // Of every frame that was not lost, whether view() would keep it.
  virtual bool wants(const Rigid3& world_from_camera) const = 0;

  // A frame of rectified(camera), without depth where something moves.
  virtual void view(RgbdFrame frame, const Rigid3& world_from_camera) = 0;

  // The map goes on in a part of its own: views of before say nothing beside those to come.
  virtual void begin_component() = 0;

  // Once a frame: the answer, so many frames after enough views were there, at most kMostAnswers in all and none after one that knows.
  // Waits for it when it is late.
  virtual std::optional<CameraCheck> answer() = 0;

  // No frame follows: an answer that is under way. Waits for it.
  virtual std::optional<CameraCheck> last_answer() = 0;

  // All of it, between frames; waits for views that are being prepared.
  virtual void save(ByteWriter& bytes) const = 0;

  // Of a watch of the same camera that has seen no frame. After a failure of the reader it is of no use any more.
  virtual void restore(ByteReader& bytes) = 0;
};

// `camera` is that of frames as they arrive.
std::unique_ptr<CameraWatch> make_camera_watch(const Camera& camera);

}  // namespace hermite
