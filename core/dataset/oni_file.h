// What lies where in an .oni file, a recording of OpenNI 1 or 2. Little endian, nothing between the fields:
//   "NI10", u8 major, u8 minor, u16 maintenance, u32 build, u64 greatest time stamp, u32 greatest node id
//   records: u32 "NIR\0", type, node id, bytes of header and fields, bytes of payload, u64 position of the record that this one undoes (u32
//   before version 1.0.1.0); fields; payload. Of the types:
//     0x02, 0x0c, 0x0d  a node begins: string name, u32 kind (2 depth, 3 colour), u32 codec; the rest, which varies, is left where it is
//     0x03 to 0x06      a property: string name, u32 bytes, value. A string is u32 bytes with the zero that ends it, and these
//     0x0a              an image: u64 time stamp [us], u32 number; the payload is the image as the node's codec has it
//     0x0b              the end. What comes behind is ignored: Debian's OpenNI2 leaves as many zeros as there was file
// The other types (states, seek tables) are passed over. One pass reads headers and fields; images stay in the file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/byte_file.h"
#include "core/image/image_codec.h"

namespace hermite {

struct OniImage {
  std::uint64_t stamp_us = 0;
  std::int64_t images_before = 0;  // of the other stream in the file
  FilePart part;
};

struct OniStream {
  std::uint32_t node = 0;
  std::string codec;                                    // four letters: "NONE", "16zP", "16zT", "JPEG"
  ImageSize size;                                       // 0x0 when the file does not say
  double frame_rate_hz = 0;                             // as set, 0 when the file does not say
  std::int64_t oni_pixel_format = 0, pixel_format = 0;  // numbers of OpenNI 2 and 1; 0 when the file does not say
  std::array<double, 2> view_rad{};                     // across, down; 0 when the file does not say
  bool is_mirrored = false, is_cropped = false;
  std::vector<OniImage> images;
};

struct OniFile {
  std::string version;  // "1.0.1.0"
  std::optional<OniStream> depth, color;
  std::string cut;  // why reading stopped before the end record; empty when it did not
};

// True for a file that begins as one of these.
bool looks_like_oni(const ByteFile& file);

// The first stream of either kind. Damage behind the first depth image ends the reading (`cut`), before it is an error: kCorruptData, with
// the offset; kUnsupported for another version; kTooLarge above kMaxFileFrames images.
Result<OniFile> read_oni_file(const ByteFile& file);

}  // namespace hermite
