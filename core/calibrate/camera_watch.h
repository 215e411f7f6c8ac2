// Checks during a scan whether its camera's calibration fits its views. It has fewer views than
// calibrate.h and is therefore more cautious: it only tests focal length, lens distortion, depth
// bend, and when the rows of the images are taken, which harm tracking most, and it only gives a
// verdict if the views agree as well as those of a camera without other errors.
//
// One thread at a time. Views are prepared and checked on helper threads; the results depend on the
// frames alone.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/byte_stream.h"
#include "core/calibrate/camera_numbers.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::calibrate {

enum class CameraVerdict { kUnknown, kFits, kIsOff };

// Errors of a camera: the shares by which depth in the corners of the image and the stated focal
// length are too great, and the error of the stated k1; or their standard deviations.
struct ShapeErrors {
  double bend = 0, focal = 0, k1 = 0;
};

struct MeasuredShape {
  ShapeErrors errors, deviations;
};

struct CameraCheck {
  CameraVerdict verdict = CameraVerdict::kUnknown;
  // The correction of a camera that is off, see changed() in camera_numbers.h. 0: this parameter is
  // not off.
  CameraVector change = CameraVector::Zero();
  // What is known of the shape of the camera, or of the corrected one: that it fits, or without a
  // verdict on it too little, or an error that not all views confirm. nullopt: nothing.
  std::optional<MeasuredShape> measured = {};
};

// The standard deviations of the remaining errors of a camera that fits: what remained of 1 % and
// 1.5 % after a correction from 12 to 16 views with a Kinect's noise (tests/accuracy/README.md, "A
// camera that is wrong").
inline constexpr ShapeErrors kFitting{.bend = 0.001, .focal = 0.0015, .k1 = 0.003};

class CameraWatch {
 public:
  virtual ~CameraWatch() = default;

  // Call it first for every frame that is not lost, with its pose relative to the last such frame;
  // nullopt if that is unknown.
  virtual void step(double timestamp_s, const std::optional<Rigid3>& last_from_camera) = 0;

  // Call it for every frame that is not lost; returns whether view() would keep the frame.
  virtual bool wants(const Rigid3& world_from_camera) const = 0;

  // Takes a frame of rectified(camera), without depth in moving regions.
  virtual void view(frame::RgbdFrame frame, const Rigid3& world_from_camera) = 0;

  // The map continues in a new component; earlier views cannot be compared with later ones.
  virtual void begin_component() = 0;

  // Call it once per frame. Returns a verdict a fixed number of frames after enough views were
  // taken, at most four times (kAsksAt) and never after a definite one. Waits for the verdict when
  // it is late.
  virtual std::optional<CameraCheck> answer() = 0;

  // Call it after the last frame. Waits for a check that is running and returns its verdict.
  virtual std::optional<CameraCheck> last_answer() = 0;

  // Saves everything between frames; waits for views that are being prepared.
  virtual void save(ByteWriter& bytes) const = 0;

  // Restores into a watch of the same camera that has seen no frame. After a failure of the reader
  // it must not be used.
  virtual void restore(ByteReader& bytes) = 0;
};

// `camera` is that of the unrectified frames.
std::unique_ptr<CameraWatch> make_camera_watch(const Camera& camera);

}  // namespace hermite::calibrate
