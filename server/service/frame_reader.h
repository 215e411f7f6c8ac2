// Reads and decodes the frames of a sequence on a second thread, a few ahead, so that the reconstruction never waits for a PNG.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "core/frame/rgbd_frame.h"

namespace hermite {

struct ReadFrame {
  std::int64_t index = 0;
  RgbdFrame frame;      // of the camera's size; without depth and black where it could not be read
  std::string problem;  // why, in words
};

class FrameReader {
 public:
  // At most `ahead` frames wait. `sequence` outlives this.
  FrameReader(const Sequence& sequence, FrameRange range, std::size_t ahead);
  ~FrameReader();  // waits for the frame in work
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  // In order, every frame of the range; nothing after the last. Blocks while the next one is read.
  std::optional<ReadFrame> next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
