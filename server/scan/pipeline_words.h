// What a pipeline tells of a frame and of its map, as the protocol and those who look at a scan have it. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "proto/wire/messages.h"
#include "server/scan/scan_worker.h"

namespace hermite {

// Without last_tracked, which is a sequence number of the scan's.
wire::FrameResult wire_result(const FrameResult& result, std::uint64_t sequence, double frame_ms);

wire::SubmapPoses wire_poses(const Pipeline& pipeline);
bool same_poses(const wire::SubmapPoses& a, const wire::SubmapPoses& b);

// Of every frame so far.
std::vector<wire::PoseInSubmap> wire_past(const Pipeline& pipeline);

// The counts and the memory of an update.
void measure(const PipelineStatistics& statistics, ModelUpdate& update);

// What is left to say about the map when the scan is over; mostly nothing.
std::string words_about_map(const PipelineStatistics& statistics);

}  // namespace hermite
