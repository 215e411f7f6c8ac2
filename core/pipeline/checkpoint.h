// The head of a checkpoint (Pipeline::save): what has to be the same where it is gone on from, in words. Pure functions, but for
// program_identity().
//
//   "HRMCKPT1", u64 count, then for each condition two texts: its name and its value (core/base/byte_stream.h)
//
// and behind it what the pipeline, its front end and its mapping write. There is no checksum: whoever keeps a checkpoint adds one. What is
// read is checked so far that nothing in it leads out of memory or to a CHECK, whatever it is.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/gpu/device_info.h"
#include "core/math/camera.h"
#include "core/pipeline/options.h"

namespace hermite {

using Conditions = std::vector<std::pair<std::string, std::string>>;  // name, value

// Device and driver, program, camera and every setting.
Conditions conditions_of(const gpu::DeviceInfo& device, const Camera& camera, const Options& options, bool with_mapping);

// What tells this build of the program from every other one: the id that the linker gives it, as hex.
std::string program_identity();

void write_head(ByteWriter& bytes, const Conditions& conditions);

// kCorruptData: no head. kUnsupported: of another format or under other conditions, naming the first that differs.
Status read_head(ByteReader& bytes, const Conditions& conditions);

}  // namespace hermite
