// Which depth codec suits a sensor: measured on some of its frames, since nobody knows beforehand how many different depths it gives.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/image.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "proto/wire/messages.h"

namespace hermite {

struct DepthCodecTrial {
  wire::DepthCodec codec = wire::DepthCodec::kRvlZstd;
  std::size_t bytes = 0;  // of all frames tried
  double encode_ms = 0;   // a frame, the median
};

// Encodes all `frames` with every codec; 0 bytes and 0 ms without frames. Blocks for that long: some 10 ms a frame of 640x480.
std::vector<DepthCodecTrial> try_depth_codecs(const std::vector<DepthImage>& frames);

// The smallest first among those within the budget, then the fastest first among the others; what is equal stays in its order.
std::vector<wire::DepthCodec> best_first(std::vector<DepthCodecTrial> trials, double budget_ms);

// The order in which to offer them to a server for these frames of a recording, by a few of them that can be read. A third of the time
// between two frames may go into depth: colour, reading and the socket share the core.
std::vector<wire::DepthCodec> depth_codecs_for(const Sequence& sequence, const FrameRange& range);

}  // namespace hermite
