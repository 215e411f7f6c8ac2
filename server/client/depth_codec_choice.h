// Chooses the depth codec for a sensor by measurement on some of its frames, since it is not known
// beforehand how many different depths a sensor produces.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/image.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "proto/wire/messages.h"

namespace hermite::client {

struct DepthCodecTrial {
  wire::DepthCodec codec = wire::DepthCodec::kRvlZstd;
  std::size_t bytes = 0;  // of all encoded frames
  double encode_ms = 0;   // median per frame
};

// Encodes all `frames` with every codec; 0 bytes and 0 ms without frames. Blocks for that long:
// some 10 ms per frame of 640x480.
std::vector<DepthCodecTrial> try_depth_codecs(const std::vector<DepthImage>& frames);

// Sorts codecs: first those within the budget by size, then the others by time. Equal ones keep
// their order.
std::vector<wire::DepthCodec> best_first(std::vector<DepthCodecTrial> trials, double budget_ms);

// Returns the order in which to offer codecs to a server for a recording, measured on a few of its
// frames that can be read. The budget is a third of the time between two frames, because colour,
// reading and the socket share the core.
std::vector<wire::DepthCodec> depth_codecs_for(const dataset::Sequence& sequence,
                                               const dataset::FrameRange& range);

}  // namespace hermite::client
