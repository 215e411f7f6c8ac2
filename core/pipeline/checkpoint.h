// The header of a checkpoint (Pipeline::save): the conditions under which it was written, as text.
// Pure functions, except program_identity().
//
//   "HRMCKPT1", u64 count, then for each condition two texts: its name and its value
//       (core/base/byte_stream.h)
//
// The state of the pipeline, its front end and its mapping follows. There is no checksum; whoever
// stores a checkpoint adds one. Reading validates the content so far that no bytes, whatever they
// are, lead to an access out of bounds or to a failing CHECK.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/gpu/device_info.h"
#include "core/math/camera.h"
#include "core/pipeline/options.h"

namespace hermite::pipeline {

using Conditions = std::vector<std::pair<std::string, std::string>>;  // name, value

// Returns device and driver, program, camera and every setting.
Conditions conditions_of(const gpu::DeviceInfo& device, const Camera& camera,
                         const Options& options, bool with_mapping);

// Returns the linker's build id as hex, which distinguishes this build of the program from every
// other one.
std::string program_identity();

void write_head(ByteWriter& bytes, const Conditions& conditions);

// Returns kCorruptData when there is no header, and kUnsupported for another format or other
// conditions, naming the first one that differs.
Status read_head(ByteReader& bytes, const Conditions& conditions);

}  // namespace hermite::pipeline
