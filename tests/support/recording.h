// A whole sequence in memory, for tests that change or reorder its frames.
#pragma once

#include <string>
#include <vector>

#include "core/base/check.h"
#include "core/source/open_sequence.h"

namespace hermite::test {

struct Recording {
  Camera camera;
  dataset::Trajectory groundtruth;
  std::vector<frame::RgbdFrame> frames;
};

inline Recording record(const std::string& source) {
  const auto sequence = source::open_sequence(source);
  CHECK(sequence.ok(), sequence.ok() ? "" : sequence.error().message);
  Recording result{(*sequence)->camera(), (*sequence)->groundtruth(), {}};
  for (std::int64_t i = 0; i < (*sequence)->frame_count(); ++i) {
    Result<dataset::RecordedFrame> recorded = (*sequence)->read(i);
    CHECK(recorded.ok(), "frame " + std::to_string(i) + " of " + source);
    Result<frame::RgbdFrame> frame = dataset::decode_frame(*std::move(recorded));
    CHECK(frame.ok(), "frame " + std::to_string(i) + " of " + source);
    result.frames.push_back(*std::move(frame));
  }
  return result;
}

}  // namespace hermite::test
