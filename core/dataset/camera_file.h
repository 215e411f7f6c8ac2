// The camera of a sequence, from camera.json or a well-known name. See also read_camera in
// sequence.h.
//
// camera.json is one object: width, height (pixels), fx, fy, cx, cy (pixels, pixel centres are
// integers), depth_units_per_metre and, optionally, frame_rate_hz and
//   color_distortion  an object with any of k1, k2, p1, p2, k3: the distortion of the colour image.
//                     If depth is registered to the distorted colour image, that of both.
//   color_camera      if depth is not registered: an object with fx, fy, cx, cy and
//                     color_from_depth, three rows of four numbers [R | t in metres]. The outer fx,
//                     fy, cx, cy are then of the depth image. null: depth is registered, whatever
//                     the format of the folder suggests.
//   depth_distortion  only together with color_camera: the distortion of the depth image.
//   depth_correction  an object with any of bend and inverse_offset_per_m
//                     (Camera::depth_correction): the error of depth as recorded. Written by
//                     `hermite calibrate`.
//   timing            an object with any of depth_readout_s, color_readout_s and color_delay_s
//                     (Camera::timing): when the rows of the images are taken. Written by `hermite
//                     calibrate`.
//   standard_deviations  an object with any of bend, focal and k1 (Camera::deviations): what may be
//                     wrong with these numbers. Written by `hermite calibrate`, and in known_camera
//                     of report.json.
//   camera_from_accelerometer  three rows of three numbers, a rotation: how the axes of the
//                     recording's accelerometer.txt lie to those of the camera (x right, y down, z
//                     forward). Without it only the benchmark's own files are used.
// Other keys are ignored.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/math/camera.h"

namespace hermite::dataset {

inline constexpr double kDefaultFrameRate_hz = 30.0;

struct CameraFile {
  Camera camera;
  double frame_rate_hz = kDefaultFrameRate_hz;
  bool says_color_camera = false;  // has the key, even if it is null
  std::optional<Eigen::Matrix3d> camera_from_accelerometer{};
};

// Errors name the key and the allowed values.
Result<CameraFile> parse_camera_json(const std::string& text);
Result<CameraFile> read_camera_json(const std::string& path);

// A camera file that lies beside a recording.
struct CameraBeside {
  CameraFile file;
  std::string name;
};

// Returns FILE.camera.json, or else camera.json in the folder of the file, with its name;
// std::nullopt if there is neither.
Result<std::optional<CameraBeside>> camera_beside(const std::string& path);

// Returns the object that parse_camera_json reads as the same camera. says_color_camera is ignored:
// the key is always written.
std::string format_camera_json(const CameraFile& file);

// Returns the camera for "fr1", "fr2", "fr3", "icl-nuim" or "redwood"; std::nullopt for any other
// name.
std::optional<Camera> known_camera(std::string_view name);

// Returns the camera of the TUM benchmark whose name (freiburg1, 2 or 3) appears in `text`, which
// is a folder's name or a comment of a file.
std::optional<Camera> camera_mentioned_in(std::string_view text);

}  // namespace hermite::dataset
