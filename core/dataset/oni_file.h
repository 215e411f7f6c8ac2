// The structure of an .oni file, a recording of OpenNI 1 or 2. Little endian, nothing between the
// fields:
//   "NI10", u8 major, u8 minor, u16 maintenance, u32 build, u64 greatest time stamp, u32 greatest
//       node id
//   records: u32 "NIR\0", type, node id, bytes of header and fields, bytes of payload, u64 position
//            of the record that this one replaces (u32 before version 1.0.1.0); fields; payload.
//            Types:
//     0x02, 0x0c, 0x0d  a node begins: string name, u32 kind (2 depth, 3 colour), u32 codec; the
//                       rest varies and is ignored
//     0x03 to 0x06      a property: string name, u32 bytes, value. A string is u32 bytes, including
//                       a final zero, and these
//     0x0a              an image: u64 time stamp [us], u32 number; the payload is the image in the
//                       node's codec
//     0x0b              the end. Anything after it is ignored: Debian's OpenNI2 appends as many
//                       zeros as the file had bytes
// Other types (states, seek tables) are skipped. One pass reads headers and fields; images stay in
// the file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/byte_file.h"
#include "core/image/image_codec.h"

namespace hermite::dataset {

struct OniImage {
  std::uint64_t stamp_us = 0;
  std::int64_t images_before = 0;  // number of images of the other stream before it in the file
  FilePart part;
};

struct OniStream {
  std::uint32_t node = 0;
  // Four letters: "NONE", "16zP", "16zT", "JPEG".
  std::string codec;
  image::ImageSize size;  // 0x0 if the file does not contain it
  // As configured; 0 if the file does not contain it.
  double frame_rate_hz = 0;
  // Numbers of OpenNI 2 and 1; 0 if the file does not contain them.
  std::int64_t oni_pixel_format = 0, pixel_format = 0;
  // Horizontal, vertical; 0 if the file does not contain them.
  std::array<double, 2> view_rad{};
  bool is_mirrored = false, is_cropped = false;
  std::vector<OniImage> images;
};

struct OniFile {
  std::string version;  // "1.0.1.0"
  std::optional<OniStream> depth, color;
  std::string cut;  // why reading stopped before the end record; empty if it did not
};

// Returns whether a file begins like an .oni file.
bool looks_like_oni(const ByteFile& file);

// Returns the first stream of each kind. Damage after the first depth image ends the reading
// (`cut`), before it is an error: kCorruptData, with the offset; kUnsupported for another version;
// kTooLarge above kMaxFileFrames images.
Result<OniFile> read_oni_file(const ByteFile& file);

}  // namespace hermite::dataset
