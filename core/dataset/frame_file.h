// What the readers of single files (.klg, .sens) share: where the images of each frame lie, and the sequence that decodes them.
#pragma once

#include <memory>
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
  FilePart depth;  // little-endian 16-bit values, or those in zlib: raw where it has just as many bytes as the pixels
  FilePart color;  // r, g, b bytes where it has as many as the pixels; none: black; else JPEG or PNG
};

struct FrameFile {
  std::string format;
  ByteFile file;
  std::vector<FrameParts> frames;  // strictly ascending in time
  Trajectory groundtruth;
  Camera camera;         // of depth, and of the colour after it was brought to that size
  ImageSize color_size;  // as stored
  double frame_rate_hz = 30;
};

// kCorruptData when there is no frame. Frames are read when they are asked for; an image that is damaged is that frame's error, with its
// offset in the file.
Result<std::unique_ptr<Sequence>> make_frame_file_sequence(FrameFile contents);

// Seconds for the stamps of a file's frames: microseconds, as both formats have it, unless the median step says that they are nano- or
// milliseconds. Where they do not ascend they are replaced by frame numbers at `frame_rate_hz`. What had to be assumed goes to `doubts`.
std::vector<double> seconds_of_stamps(const std::vector<std::int64_t>& stamps, double frame_rate_hz, std::vector<std::string>& doubts);

}  // namespace hermite
