// Where a sequence's camera comes from: camera.json or a name everybody knows. See also read_camera in sequence.h.
//
// camera.json is one object: width, height (pixels), fx, fy, cx, cy (pixels, pixel centres are integers), depth_units_per_metre and,
// optionally, frame_rate_hz and
//   color_distortion  an object with any of k1, k2, p1, p2, k3. Where depth is registered to the colour image as it is, the lens of both.
//   color_camera      where depth is not registered: an object with fx, fy, cx, cy and color_from_depth, three rows of four numbers
//                     [R | t in metres]. The outer fx, fy, cx, cy are then of the depth image. null: depth is registered, whatever the
//                     folder's format makes likely.
//   depth_distortion  beside color_camera only: the lens of the depth image.
//   depth_correction  an object with any of bend and inverse_offset_per_m (Camera::depth_correction): what is wrong with depth as it is
//                     recorded. `hermite calibrate` writes it.
// Other keys are ignored.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/math/camera.h"

namespace hermite {

inline constexpr double kDefaultFrameRate_hz = 30.0;

struct CameraFile {
  Camera camera;
  double frame_rate_hz = kDefaultFrameRate_hz;
  bool says_color_camera = false;  // has the key, be it null
};

// Errors name the key and what is allowed.
Result<CameraFile> parse_camera_json(const std::string& text);
Result<CameraFile> read_camera_json(const std::string& path);

// FILE.camera.json, else camera.json in the file's folder, with its name; nothing when neither is there.
struct CameraBeside {
  CameraFile file;
  std::string name;
};
Result<std::optional<CameraBeside>> camera_beside(const std::string& path);

// The object that parse_camera_json reads as the same camera; says_color_camera does not matter, the key is always there.
std::string format_camera_json(const CameraFile& file);

// "fr1", "fr2", "fr3", "icl-nuim" or "redwood"; nothing for any other name.
std::optional<Camera> known_camera(std::string_view name);

// The camera of the TUM benchmark whose name (freiburg1, 2 or 3) appears in `text`: a folder's name or a file's comment.
std::optional<Camera> camera_mentioned_in(std::string_view text);

}  // namespace hermite
