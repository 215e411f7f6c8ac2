// One frame of a sequence, read and decoded.
#pragma once

#include <cstdint>
#include <string>

#include "core/dataset/sequence.h"
#include "core/frame/rgbd_frame.h"

namespace hermite {

struct ReadFrame {
  std::int64_t index = 0;
  RgbdFrame frame;      // of the camera's size; without depth and black where it could not be read
  std::string problem;  // why, in words
};

// Any thread.
ReadFrame read_frame(const Sequence& sequence, std::int64_t index);

}  // namespace hermite
