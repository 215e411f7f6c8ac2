// Reads and decodes one frame of a sequence.
#pragma once

#include <cstdint>
#include <string>

#include "core/dataset/sequence.h"
#include "core/frame/rgbd_frame.h"

namespace hermite::dataset {

struct ReadFrame {
  std::int64_t index = 0;
  frame::RgbdFrame frame;  // of the camera's size; black and without depth if it could not be read
  std::string problem;     // the reason, as text
};

// Any thread.
ReadFrame read_frame(const Sequence& sequence, std::int64_t index);

}  // namespace hermite::dataset
