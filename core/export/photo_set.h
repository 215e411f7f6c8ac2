// Undistorted keyframes of a scan with poses and points, as input for photogrammetry and splat
// programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/export/keyframes.h"
#include "core/frame/rectify.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/output/cloud.h"

namespace hermite::exports {

// The data to export, which the caller keeps alive. The cloud is in the world of the trajectory.
// The sequence has the final camera of the scan (RecalibratedSequence), and poses are those of its
// depth image, to which colour is registered.
struct PhotoSource {
  const dataset::Sequence& sequence;
  const dataset::Trajectory& trajectory;
  const output::Cloud& cloud;
};

struct PhotoOptions {
  KeyframeOptions keyframes{};
  // The most that splat programs start with; they add points where needed.
  std::size_t most_points = 100'000;
};

struct PhotoSummary {
  std::size_t frame_count = 0;    // of the sequence
  std::size_t tracked_count = 0;  // of these, frames with a pose
  std::size_t image_count = 0;    // written
  std::size_t point_count = 0;    // points written
};

// A keyframe as it is written, seen by the pinhole camera rectified(camera).
struct Photo {
  frame::RgbdFrame frame;  // rectified, colour registered to depth
  // The recorded bytes if the image needed no rectification, else lossless PNG.
  std::vector<std::uint8_t> color_bytes;
  // "frame_000123.jpg" or .png, by its index in the sequence.
  std::string name;
};
class PhotoReader {
 public:
  explicit PhotoReader(const dataset::Sequence& sequence);
  // Reads a keyframe; errors as Sequence::read.
  Result<Photo> read(std::int64_t index) const;

 private:
  const dataset::Sequence& sequence_;
  const std::optional<frame::Rectifier> rectifier_;
};

}  // namespace hermite::exports
