#include "core/dataset/read_frame.h"

#include <utility>

#include "proto/wire/frame_payload.h"

namespace hermite::dataset {

ReadFrame read_frame(const Sequence& sequence, std::int64_t index) {
  const Camera& camera = sequence.camera();
  Result<RecordedFrame> recorded = sequence.read(index);
  Result<frame::RgbdFrame> frame = recorded.ok() ? decode_frame(*std::move(recorded))
                                                 : Result<frame::RgbdFrame>(recorded.error());
  if (frame.ok()) return {index, *std::move(frame), ""};
  return {index, wire::empty_frame(sequence.timestamp_s(index), camera), frame.error().message};
}

}  // namespace hermite::dataset
