// Converts results of the pipeline to protocol messages. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "proto/wire/messages.h"
#include "server/scan/scan_worker.h"

namespace hermite::server {

// Without last_tracked, which needs the sequence numbers of the scan.
wire::FrameResult wire_result(const pipeline::FrameResult& result, std::uint64_t sequence,
                              double frame_ms);

wire::SubmapPoses wire_poses(const pipeline::Pipeline& pipeline);
bool same_poses(const wire::SubmapPoses& a, const wire::SubmapPoses& b);

// The poses of all frames so far.
std::vector<wire::PoseInSubmap> wire_past(const pipeline::Pipeline& pipeline);

// Sets the counts and the memory of an update.
void measure(const pipeline::PipelineStatistics& statistics, ModelUpdate& update);

// A remark about the map of an ended scan; usually empty.
std::string remark_about_map(const pipeline::PipelineStatistics& statistics);

}  // namespace hermite::server
