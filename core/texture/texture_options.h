// What texturing a mesh starts from and how it goes about it. Plain values.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// The colour images of a recording. Frames are read again and again rather than kept.
struct TextureFrames {
  Camera camera;                                         // of the straight images: no distortion, no camera for the colour alone
  std::vector<std::optional<Rigid3>> world_from_camera;  // by frame, in order of time; none: the frame was lost
  // The straight image of a frame, of the camera's size. Called by several threads at once. A frame that cannot be read is passed over.
  std::function<Result<ColorImage>(std::size_t frame)> read;
  // By pixel, 0: beyond the lens's image, no colour there in any frame. Empty: all pixels have one.
  Image<std::uint8_t> is_seen;
};

struct TextureOptions {
  double texel_m = 0.002;    // largest side of a texel on the surface, 0.0002 to 0.1; larger where the surface would not fit the pages
  int page_px = 4096;        // side of a page of the texture, 256 to 8192
  int max_pages = 8;         // 1 to 64: bounds memory
  int max_views = 200;       // 1 to 1000 frames that colour is taken from; their images are in memory at the same time
  double view_step_m = 0.1;  // of two views less than this and less than view_turn_deg apart, only the sharper is used
  double view_turn_deg = 10;
  int blended_views = 4;        // 1 to 8: of a texel
  bool solves_exposure = true;  // gains of the views
  bool refines_poses = true;    // photometrically, against the surface; and bends the images by what no pose explains
  int thread_count = 0;         // 0: as many as the processor has
  // Asked by all threads, far more often than the progress is told: true, what is made is thrown away and not finished. Empty: never.
  std::function<bool()> is_stopped;
};

// Told the share that is done, 0 to 1, by the calling thread, some times a second on usual machines. False: stop.
using TextureProgress = std::function<bool(double share)>;

inline bool is_stopped(const TextureOptions& options) { return options.is_stopped && options.is_stopped(); }

// kInvalidArgument, naming the field and its limits.
Status validate(const TextureOptions& options);
Status validate(const TextureFrames& frames);

}  // namespace hermite
