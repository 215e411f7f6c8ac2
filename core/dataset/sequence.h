// A recorded or synthetic RGB-D sequence of any format.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::dataset {

// A frame as recorded: depth is decoded, colour is still encoded as in its file, which is what a
// client sends.
struct RecordedFrame {
  double timestamp_s = 0;
  DepthImage depth;                                    // sensor units
  std::vector<std::uint8_t> color_bytes;               // JPEG or PNG, as in the recording
  std::optional<Eigen::Vector3d> acceleration_m_s2{};  // as in frame::RgbdFrame
};

// Const functions are thread-safe.
class Sequence {
 public:
  virtual ~Sequence() = default;
  // "tum", "icl-nuim", "7-scenes", "redwood", "images", "klg", "sens", "oni", "raw", "frame log",
  // "synthetic".
  virtual std::string format() const = 0;
  virtual std::string name() const = 0;  // for titles: the folder's name
  virtual const Camera& camera() const = 0;
  virtual double frame_rate_hz() const = 0;  // nominal
  virtual std::int64_t frame_count() const = 0;
  // Time stamps strictly ascend with the index.
  virtual double timestamp_s(std::int64_t index) const = 0;
  // An unreadable frame is an error of that frame only; the caller continues with the next.
  virtual Result<RecordedFrame> read(std::int64_t index) const = 0;
  // Returns world_from_camera at the ground truth's own times; empty if there is none.
  virtual const Trajectory& groundtruth() const = 0;
};

// Reads a camera.json as described in the README, or returns the camera of one of the names fr1,
// fr2, fr3, icl-nuim, redwood.
Result<Camera> read_camera(const std::string& path_or_name);

// Decodes the colour, as the pipeline needs it. The server uses the same function for received
// frames.
Result<frame::RgbdFrame> decode_frame(RecordedFrame recorded);

}  // namespace hermite::dataset
