// Shared by the readers of single files (.klg, .sens, .oni): the positions of each frame's images,
// and the sequence that reads them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/dataset/byte_file.h"
#include "core/dataset/recording.h"
#include "core/image/image_codec.h"

namespace hermite::dataset {

// Nine hours at 30 Hz, as for raw frame files.
inline constexpr std::int64_t kMaxFileFrames = 1'000'000;
// Twice the size of the raw images of the largest camera; compressed noise is only slightly larger
// than once that size.
inline constexpr std::int64_t kMaxDepthPart_bytes =
    std::int64_t{2} * 2 * kMaxImageSide_px * kMaxImageSide_px;
// Colour may be larger than depth: ScanNet's is twice as wide.
inline constexpr int kMaxStoredColorSide_px = 4096;
inline constexpr std::int64_t kMaxColorPart_bytes =
    std::int64_t{3} * kMaxStoredColorSide_px * kMaxStoredColorSide_px;

struct FrameParts {
  double timestamp_s = 0;
  FilePart depth;
  FilePart color;  // empty: black
};

// Decode the bytes of a frame's images. Called from the thread that reads the frame.
struct FrameDecoders {
  std::function<Result<DepthImage>(std::vector<std::uint8_t> bytes)> depth;
  // Returns a JPEG or PNG of the depth's size.
  std::function<Result<std::vector<std::uint8_t>>(std::vector<std::uint8_t> bytes)> color;
};

// Depth: little-endian 16-bit values, or these compressed with zlib; raw if the number of bytes is
// that of the pixels. Colour: r, g, b bytes if the number of bytes is that of the pixels, otherwise
// JPEG or PNG.
FrameDecoders raw_or_packed(image::ImageSize size, image::ImageSize color_size);

struct FrameFile {
  std::string format;
  ByteFile file;
  std::vector<FrameParts> frames;  // strictly ascending in time
  Trajectory groundtruth;
  Camera camera;  // of depth, and of the colour as decoded
  FrameDecoders decoders;
  double frame_rate_hz = 30;
};

// kCorruptData when there is no frame. Frames are read on demand; a damaged image is an error of
// that frame only, with its offset in the file.
Result<std::unique_ptr<Sequence>> make_frame_file_sequence(FrameFile contents);

// Opens the file; errors of `open` get its path.
Result<Recording> open_file_with(Result<Recording> (*open)(ByteFile file,
                                                           const std::optional<Camera>& camera),
                                 const std::string& path, const std::optional<Camera>& camera);

// Returns the times [s] for the stamps of a file's frames: they are microseconds, as in both
// formats, unless the median step shows that they are nano- or milliseconds. If they do not ascend
// they are replaced by frame numbers at `frame_rate_hz`. Assumptions are appended to `doubts`.
std::vector<double> seconds_of_stamps(const std::vector<std::int64_t>& stamps, double frame_rate_hz,
                                      std::vector<std::string>& doubts);

}  // namespace hermite::dataset
