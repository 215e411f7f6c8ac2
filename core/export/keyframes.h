// Choice of keyframes for photogrammetry: sharp frames from different positions and directions.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"

namespace hermite::exports {

struct KeyframeOptions {
  double spacing_m = 0.10, spacing_deg = 10;  // two keyframes differ by at least one of these
  // The sharpest of this many consecutive frames is taken: a fifth of a second, in which a hand
  // shakes once.
  int window_frames = 6;
  std::size_t most = 1000;  // with more, both spacings grow
};

// Returns the variance of the Laplacian of the brightness, which motion blur and defocus reduce
// (Pech-Pacheco et al., "Diatom autofocusing in brightfield microscopy", 2000). Comparable only
// between images of one scene. 0 for an image without inner pixels.
double sharpness(const ColorImage& image);

struct SeenFrame {
  std::int64_t index = 0;  // in the sequence
  Rigid3 world_from_camera;
  double sharpness = 0;
};

// Chooses among ordered frames: the first frame apart from all keyframes so far opens a window, and
// the sharpest such frame in the window becomes a keyframe. Pure.
std::vector<SeenFrame> choose_keyframes(const std::vector<SeenFrame>& frames,
                                        const KeyframeOptions& options);

// Called now and then with the work done; returning false stops the work.
using ExportProgress = std::function<bool(std::int64_t done, std::int64_t total)>;

// Returns the tracked frames whose timestamp matches a pose within 0.1 ms; lost ones are skipped
// (tracked_frames). Returns kNotFound when no frame has a pose.
Result<std::vector<SeenFrame>> frames_with_poses(const dataset::Sequence& sequence,
                                                 const dataset::Trajectory& trajectory);

// Reads all of `frames` to measure their sharpness, and chooses keyframes. Unreadable frames are
// skipped. Returns kBusy when `progress` stopped it, and kNotFound when no frame remains.
Result<std::vector<SeenFrame>> find_keyframes(const dataset::Sequence& sequence,
                                              std::vector<SeenFrame> frames,
                                              const KeyframeOptions& options,
                                              const ExportProgress& progress);

// The error of functions in this folder that `progress` has stopped.
Error ended_early();

}  // namespace hermite::exports
