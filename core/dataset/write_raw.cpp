#include "core/dataset/write_raw.h"

#include <filesystem>

#include "core/dataset/remarks.h"
#include "core/raw/raw_frames.h"

namespace hermite::dataset {

Result<WriteSummary> write_raw(const Sequence& sequence, FrameRange range, const std::string& path,
                               const WriteProgress& progress) {
  if (std::filesystem::exists(path))
    return Error{ErrorCode::kInvalidArgument, path + " exists already"};
  const Camera& camera = sequence.camera();
  Result<RawFrameWriter> writer = RawFrameWriter::create(path, camera, range.count());
  if (!writer.ok()) return writer.error();
  Remarks empty("frames that cannot be read are black and without depth");
  for (std::int64_t i = range.begin; i < range.end; ++i) {
    Result<RecordedFrame> recorded = sequence.read(i);
    Result<frame::RgbdFrame> frame = recorded.ok() ? decode_frame(*std::move(recorded))
                                                   : Result<frame::RgbdFrame>(recorded.error());
    if (!frame.ok()) {
      empty.add(frame.error().message);
      frame = frame::RgbdFrame{sequence.timestamp_s(i), DepthImage(camera.width, camera.height),
                               ColorImage(camera.width, camera.height)};
    }
    if (const Status status = writer->append(*frame); !status.ok()) return status.error();
    progress(i - range.begin + 1);
  }
  if (const Status status = writer->finish(); !status.ok()) return status.error();
  return WriteSummary{range.count(), empty.lines()};
}

}  // namespace hermite::dataset
