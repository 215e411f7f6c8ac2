// A pinhole camera with depth registered to colour, or with a second camera beside it for the
// colour. Pixel centres are integers: u = fx x / z + cx. The camera frame is x right, y down, z
// forward, in metres. Plain values.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/base/result.h"
#include "core/math/image_timing.h"
#include "core/math/rigid3.h"

namespace hermite {

// Allowed image sizes. The lower bound leaves a useful size for three pyramid levels, the upper one
// limits the memory of a scan.
inline constexpr int kMinImageSide_px = 64;
inline constexpr int kMaxImageSide_px = 2048;

// Limits for the depth of a calibrated sensor: an error of a tenth in the corners, and of a tenth
// at 2 m.
inline constexpr double kMaxBend = 0.1;
inline constexpr double kMaxInverseOffset_per_m = 0.05;

// Lens distortion as in OpenCV: x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2
// x^2), y' alike, at z = 1. Zero: none.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  bool operator==(const Distortion&) const = default;

  Eigen::Vector2d apply(double x, double y) const {
    const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }
  // The inverse of apply() by fixed-point iteration, as in OpenCV. Each step reduces the error by
  // the distortion's own share there; where that is more than a whole, nothing is undone.
  Eigen::Vector2d undo(double x, double y) const {
    Eigen::Vector2d straight(x, y);
    if (*this == Distortion{}) return straight;
    for (int i = 0; i < kUndoSteps; ++i) {
      const Eigen::Vector2d off = Eigen::Vector2d(x, y) - apply(straight.x(), straight.y());
      straight += off;
      if (off.squaredNorm() < kUndone * kUndone) break;
    }
    return straight;
  }
  static constexpr int kUndoSteps = 30;
  static constexpr double kUndone = 1e-7;  // a ten thousandth of a pixel
};

// A factor for all depths is the scale of the world, which cannot be observed in a scan. So the
// correction leaves this depth unchanged, from which rooms are typically scanned.
inline constexpr double kUndistortedDepth_m = 2;

// Corrects a sensor's depth, smoothly over the image: with b = measured (1 + bend rho^2), where rho
// is the distance from the middle of the undistorted image, 1 in its corners, the true depth is b
// (1 + o kUndistortedDepth_m) / (1 + o b), with o = inverse_offset_per_m. The bend is the
// first-order error of a badly calibrated lens. The offset is an error of the disparity, which
// structured light and stereo measure: the D(x, y) of BAD SLAM (Schoeps et al. 2019), but one for
// all pixels and without its decay. Zero: none.
struct DepthCorrection {
  double bend = 0;
  double inverse_offset_per_m = 0;
  bool operator==(const DepthCorrection&) const = default;

  // Returns 0 if there is no depth: measured is 0, or the offset leaves no point in front of the
  // camera.
  double true_depth_m(double measured_m, double rho2) const {
    const double bent_m = measured_m * (1 + bend * rho2),
                 divisor = 1 + inverse_offset_per_m * bent_m;
    return divisor > 0 ? bent_m * (1 + inverse_offset_per_m * kUndistortedDepth_m) / divisor : 0;
  }
};

// The largest distance between the depth and colour cameras of one device.
inline constexpr double kMaxColorBaseline_m = 0.5;

// The colour camera of a device whose depth is not registered to colour. Its image has as many
// pixels as the depth image.
struct ColorCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  Distortion distortion{};                // of the colour image as received
  Rigid3 color_from_depth{};              // everywhere else "the camera" is the depth camera
  bool operator==(const ColorCamera& other) const;
};

// Standard deviations of what may be wrong with a camera's numbers, from an earlier calibration. 0:
// not known, as for any camera that was never checked (core/track/map_certainty.cpp).
struct CameraDeviations {
  double bend = 0;   // of DepthCorrection::bend
  double focal = 0;  // of the focal lengths, as a share
  double k1 = 0;     // of Distortion::k1
  bool operator==(const CameraDeviations&) const = default;
};
inline constexpr double kMaxCameraDeviation = 0.1;

struct Camera {
  int width = 0;                          // pixels
  int height = 0;                         // pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  double depth_units_per_metre = 1000;    // sensor value for a depth of one metre
  // Distortion of both images as received; project and unproject are for undistorted pixels.
  Distortion distortion{};
  // Nullopt: depth is registered to colour. Otherwise all of the above is of the depth image only.
  std::optional<ColorCamera> color{};
  DepthCorrection depth_correction{};  // of depth as received, by pixel of the undistorted image
  ImageTiming timing{};                // of both images as received
  CameraDeviations deviations{};       // of the numbers above
  bool operator==(const Camera&) const = default;

  Eigen::Vector2d project(const Eigen::Vector3d& point_in_camera) const {
    return {fx * point_in_camera.x() / point_in_camera.z() + cx,
            fy * point_in_camera.y() / point_in_camera.z() + cy};
  }
  // Returns where the distorted image shows what an undistorted image has at pixel (u, v).
  Eigen::Vector2d distort(double u, double v) const {
    const Eigen::Vector2d at = distortion.apply((u - cx) / fx, (v - cy) / fy);
    return {at.x() * fx + cx, at.y() * fy + cy};
  }
  // The inverse of distort().
  Eigen::Vector2d undistort(double u, double v) const {
    const Eigen::Vector2d at = distortion.undo((u - cx) / fx, (v - cy) / fy);
    return {at.x() * fx + cx, at.y() * fy + cy};
  }
  // Returns, for an undistorted pixel, the squared distance from the middle of the image, 1 in the
  // corners.
  double rho2(double u, double v) const {
    const double middle_x = 0.5 * (width - 1), middle_y = 0.5 * (height - 1);
    const double dx = u - middle_x, dy = v - middle_y;
    return (dx * dx + dy * dy) / (middle_x * middle_x + middle_y * middle_y);
  }
  Eigen::Vector3d unproject(double u, double v, double depth_m) const {
    return {(u - cx) / fx * depth_m, (v - cy) / fy * depth_m, depth_m};
  }
};

// Returns the camera of rectified frames (core/frame/rectify.h) that show one instant
// (core/frame/retime.h): without distortion and depth correction, colour registered, all pixels
// taken at the time stamp.
Camera rectified(const Camera& camera);

// Returns kInvalidArgument, naming the field and its limits, for sizes outside [kMinImageSide_px,
// kMaxImageSide_px], focal lengths that are not positive and finite or give a field of view outside
// 10 to 150 degrees, a principal point outside the image, a depth scale outside [1, 1e6], a bend
// beyond +-kMaxBend, an inverse offset beyond +-kMaxInverseOffset_per_m, readouts beyond
// +-kMaxReadout_s, a delay beyond +-kMaxColorDelay_s, standard deviations outside [0,
// kMaxCameraDeviation], and a distortion that moves a corner of the image by more than a quarter of
// its width; the same for the colour camera (fields camera.color.*), and for a color_from_depth
// with a quaternion that is not of unit length within 1e-3 or a translation of more than
// kMaxColorBaseline_m.
Status validate(const Camera& camera);

}  // namespace hermite
