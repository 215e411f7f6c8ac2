// Keyframes of a scan as pictures without distortion, with poses and points: what photogrammetry and splat programs begin with.
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

namespace hermite {

// What is exported; the caller keeps it alive. The cloud lies in the world of the trajectory. The sequence's camera is the one that the
// scan was made with at last (RecalibratedSequence), and poses are those of its depth image, into which colour is brought.
struct PhotoSource {
  const Sequence& sequence;
  const Trajectory& trajectory;
  const Cloud& cloud;
};

struct PhotoOptions {
  KeyframeOptions keyframes{};
  std::size_t most_points = 100'000;  // what splat programs begin with at most; they make more where they need them
};

struct PhotoSummary {
  std::size_t frame_count = 0;    // of the sequence
  std::size_t tracked_count = 0;  // of these, with a pose
  std::size_t picture_count = 0;  // written
  std::size_t point_count = 0;    // written
};

// A keyframe as it is written: seen by one pinhole, rectified(camera).
struct Picture {
  RgbdFrame frame;                        // straight, colour registered to depth
  std::vector<std::uint8_t> color_bytes;  // the recording's own where it was straight already, else PNG: nothing is lost
  std::string name;                       // "frame_000123.jpg" by its place in the sequence, or .png
};
class PictureReader {
 public:
  explicit PictureReader(const Sequence& sequence);
  // As Sequence::read.
  Result<Picture> read(std::int64_t index) const;

 private:
  const Sequence& sequence_;
  const std::optional<Rectifier> rectifier_;
};

}  // namespace hermite
