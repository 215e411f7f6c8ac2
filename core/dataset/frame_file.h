// What the readers of single files (.klg, .sens, .oni) share: where the images of each frame lie, and the sequence that reads them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/dataset/byte_file.h"
#include "core/dataset/recording.h"
#include "core/image/image_codec.h"

namespace hermite {

inline constexpr std::int64_t kMaxFileFrames = 1'000'000;  // nine hours at 30 Hz, as raw frame files have
// Twice the raw images of the largest camera: what a compressor makes of noise is only little more than once.
inline constexpr std::int64_t kMaxDepthPart_bytes = std::int64_t{2} * 2 * kMaxImageSide_px * kMaxImageSide_px;
inline constexpr int kMaxStoredColorSide_px = 4096;  // colour may be larger than depth: ScanNet's is twice as wide
inline constexpr std::int64_t kMaxColorPart_bytes = std::int64_t{3} * kMaxStoredColorSide_px * kMaxStoredColorSide_px;

struct FrameParts {
  double timestamp_s = 0;
  FilePart depth;
  FilePart color;  // none: black
};

// What the bytes of a frame's images become. Called from whatever thread reads the frame.
struct FrameDecoders {
  std::function<Result<DepthImage>(std::vector<std::uint8_t> bytes)> depth;
  std::function<Result<std::vector<std::uint8_t>>(std::vector<std::uint8_t> bytes)> color;  // a JPEG or PNG of the depth's size
};

// Depth: little-endian 16-bit values, or those in zlib: raw where there are just as many bytes as the pixels have. Colour: r, g, b bytes
// where there are as many as the pixels have, else JPEG or PNG.
FrameDecoders raw_or_packed(ImageSize size, ImageSize color_size);

struct FrameFile {
  std::string format;
  ByteFile file;
  std::vector<FrameParts> frames;  // strictly ascending in time
  Trajectory groundtruth;
  Camera camera;  // of depth, and of the colour as it is decoded
  FrameDecoders decoders;
  double frame_rate_hz = 30;
};

// kCorruptData when there is no frame. Frames are read when they are asked for; an image that is damaged is that frame's error, with its
// offset in the file.
Result<std::unique_ptr<Sequence>> make_frame_file_sequence(FrameFile contents);

// Opens the file, and names it in the errors of `open`.
Result<Recording> open_file_with(Result<Recording> (*open)(ByteFile file, const std::optional<Camera>& camera), const std::string& path,
                                 const std::optional<Camera>& camera);

// Seconds for the stamps of a file's frames: microseconds, as both formats have it, unless the median step says that they are nano- or
// milliseconds. Where they do not ascend they are replaced by frame numbers at `frame_rate_hz`. What had to be assumed goes to `doubts`.
std::vector<double> seconds_of_stamps(const std::vector<std::int64_t>& stamps, double frame_rate_hz, std::vector<std::string>& doubts);

}  // namespace hermite
