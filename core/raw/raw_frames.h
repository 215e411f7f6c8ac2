// Frames as the pipeline eats them, undecoded, in one file: `hermite reconstruct --dump-raw` writes
// it, hermite_bench reads it on a machine that has no image codecs.
//
// Little endian, nothing between the fields:
//   8 bytes  "HRMFRAME"
//   u32      version, 1 and, where they are there, 1, 2 and 4 more for the second, third and fourth
//            group of f64
//   u32      width, height of depth and colour [px]
//   u32      frame_count, 1 to kMaxRawFrames
//   f64      fx, fy, cx, cy [px], depth_units_per_metre, k1, k2, p1, p2, k3 (core/math/camera.h)
//   f64      second group, written where a camera of its own took the colour: fx, fy, cx, cy, k1,
//            k2, p1, p2, k3 of that, color_from_depth as quaternion x, y, z, w and translation x,
//            y, z [m]
//   f64      third group, written where the sensor distorts depth: bend, inverse_offset_per_m
//   f64      fourth group, written where rows are taken at different times: depth_readout_s,
//            color_readout_s, color_delay_s
//   frames   each f64 timestamp_s, width * height u16 depth in sensor units, width * height times
//            r, g, b as u8
// So the header tells the size of the file. Any other size is a file cut short, or no such file.
//
// Both ends: one thread at a time. Movable.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "core/base/result.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

// Nine hours at 30 Hz.
inline constexpr std::int64_t kMaxRawFrames = 1'000'000;

class RawFrameWriter {
 public:
  // Makes the file, or empties it. kIo; kInvalidArgument for a camera that validate() refuses or a
  // count outside 1 to kMaxRawFrames.
  static Result<RawFrameWriter> create(const std::string& path, const Camera& camera,
                                       std::int64_t frame_count);

  // kInvalidArgument for a frame of another size than the camera's and for one more than promised;
  // kIo when the disk is full.
  Status append(const frame::RgbdFrame& frame);

  // To be called after the last frame: kInvalidArgument when some are missing, kIo when the disk
  // did not take all of them.
  Status finish();

 private:
  RawFrameWriter() = default;
  Error cannot_write() const;

  std::string path_;
  std::ofstream file_;
  Camera camera_;
  std::int64_t frame_count_ = 0, written_count_ = 0;
};

class RawFrameReader {
 public:
  // Reads and judges the header; frames stay on the disk. kNotFound, kIo, or kCorruptData naming
  // the field, its value and what is allowed.
  static Result<RawFrameReader> open(const std::string& path);

  const Camera& camera() const { return camera_; }
  std::int64_t frame_count() const { return frame_count_; }

  // CHECK: 0 <= index < frame_count(). kIo, or kCorruptData for a time stamp that is no number.
  Result<frame::RgbdFrame> read(std::int64_t index);
  // The time stamp alone, with the same errors.
  Result<double> timestamp_s(std::int64_t index);

 private:
  RawFrameReader() = default;
  Error corrupt(const std::string& message) const;

  std::string path_;
  std::ifstream file_;
  Camera camera_;
  std::int64_t frame_count_ = 0;
  std::int64_t header_bytes_ = 0;
};

}  // namespace hermite
