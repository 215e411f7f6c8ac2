// The inputs and options of texturing a mesh. Plain values.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite::texture {

// The colour images of a recording. Frames are read whenever they are needed rather than kept in
// memory.
struct TextureFrames {
  // Camera of the undistorted images, without a separate colour camera.
  Camera camera;
  // By frame, in order of time; nullopt: the frame was lost.
  std::vector<std::optional<Rigid3>> world_from_camera;
  // Returns the undistorted image of a frame, of the camera's size. Called by several threads at
  // once. A frame that cannot be read is skipped.
  std::function<Result<ColorImage>(std::size_t frame)> read;
  // By pixel, 0: outside the image of the lens, and without colour in every frame. Empty: all
  // pixels have colour.
  Image<std::uint8_t> is_seen;
};

struct TextureOptions {
  // Largest texel side on the surface, 0.0002 to 0.1; larger if the surface would not fit the
  // pages.
  double texel_m = 0.002;
  int page_px = 4096;  // side of a page of the texture, 256 to 8192
  int max_pages = 8;   // 1 to 64: bounds memory
  // 1 to 1000 frames from which colour is taken; all their images are in memory at once.
  int max_views = 200;
  // Of two views that are closer than this and than view_turn_deg, only the sharper is used.
  double view_step_m = 0.1;
  double view_turn_deg = 10;
  int blended_views = 4;        // 1 to 8 views per texel
  bool solves_exposure = true;  // estimate a gain for each view
  // Photometric pose refinement, and warps of the images for what poses cannot explain.
  bool refines_poses = true;
  int thread_count = 0;  // 0: one per processor
  // Called by all threads, far more often than the progress is reported. Returns true to abandon
  // the work. Empty: never.
  std::function<bool()> is_stopped;
};

// Called by the calling thread with the fraction that is done, 0 to 1, usually several times a
// second. Returns false to stop.
using TextureProgress = std::function<bool(double share)>;

inline bool is_stopped(const TextureOptions& options) {
  return options.is_stopped && options.is_stopped();
}

// Return kInvalidArgument, naming the field and its limits.
Status validate(const TextureOptions& options);
Status validate(const TextureFrames& frames);

}  // namespace hermite::texture
