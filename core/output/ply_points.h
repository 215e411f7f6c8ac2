// Streams the points of a file written by format_ply in little memory, for callers that need a few
// of many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::output {

// Returns at most `max_bytes` from `offset` on; fewer at the end of the file, and none after it.
using ReadPart = std::function<Result<std::string>(std::uint64_t offset, std::size_t max_bytes)>;

// Calls use(point) in the file's order, with some megabytes of the file in memory at a time.
// Returns kUnsupported for a PLY that format_ply did not write, kCorruptData when it is cut, and
// the errors of `read`.
Status for_each_ply_point(const ReadPart& read, const std::function<void(const CloudPoint&)>& use);

}  // namespace hermite::output
