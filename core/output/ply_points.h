// The points of a file that format_ply has written, one after the other, in little memory: for who wants a few of many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

// At most `max_bytes` from `offset` on: less where the file ends, nothing behind its end.
using ReadPart = std::function<Result<std::string>(std::uint64_t offset, std::size_t max_bytes)>;

// Calls use(point) in the file's order; holds some megabytes of it at a time. kUnsupported: a PLY that is not as format_ply writes them.
// kCorruptData: cut. What `read` answers.
Status for_each_ply_point(const ReadPart& read, const std::function<void(const CloudPoint&)>& use);

}  // namespace hermite
