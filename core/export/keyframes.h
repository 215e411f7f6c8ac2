// Which frames of a recording are worth being pictures for photogrammetry: sharp ones, seen from places and in directions apart.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"

namespace hermite {

struct KeyframeOptions {
  double spacing_m = 0.10, spacing_deg = 10;  // a keyframe is nearer than neither to another one: one or the other is kept
  int window_frames = 6;                      // the sharpest of so many in a row: a fifth of a second, in which a hand shakes once
  std::size_t most = 1000;                    // with more, both spacings grow
};

// The variance of the Laplacian of the brightness: how much of a picture is edges, which motion and a lens out of focus take away (Pech-
// Pacheco et al., "Diatom autofocusing in brightfield microscopy", 2000). Comparable between pictures of one scene only. 0 for a picture
// without inner pixels.
double sharpness(const ColorImage& image);

struct SeenFrame {
  std::int64_t index = 0;  // in the sequence
  Rigid3 world_from_camera;
  double sharpness = 0;
};

// Of frames in their order: the first that is apart from all keyframes so far opens a window, the sharpest in it that is apart too becomes
// one. Pure.
std::vector<SeenFrame> choose_keyframes(const std::vector<SeenFrame>& frames, const KeyframeOptions& options);

// Called now and then with what is done of all; false ends the work.
using ExportProgress = std::function<bool(std::int64_t done, std::int64_t total)>;

// The frames whose time stamps a pose has within 0.1 ms, those left out that were lost (tracked_frames). kNotFound: not one has a pose.
Result<std::vector<SeenFrame>> frames_with_poses(const Sequence& sequence, const Trajectory& trajectory);

// Reads all of `frames` to see how sharp they are, and chooses. Frames that cannot be read are left out. kBusy: ended by `progress`.
// kNotFound: no frame is left.
Result<std::vector<SeenFrame>> find_keyframes(const Sequence& sequence, std::vector<SeenFrame> frames, const KeyframeOptions& options,
                                              const ExportProgress& progress);

// What those of the functions in this folder return that `progress` has ended.
Error ended_early();

}  // namespace hermite
