// The state of an atlas in our own byte format (core/base/byte_stream.h). What follows from the
// rest is left out: the landmark of each feature, and what publish() sets.
#pragma once

#include "core/adjust/submap_atlas.h"
#include "core/base/byte_stream.h"

namespace hermite::adjust {

void save(ByteWriter& bytes, const SubmapAtlas& atlas);

// Restores into an atlas of the same camera. After a failure of the reader the atlas must not be
// used.
void restore(ByteReader& bytes, SubmapAtlas& atlas);

}  // namespace hermite::adjust
