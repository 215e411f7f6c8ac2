// Checkpoints of scans, and the head of a pipeline's. Input: a byte for the way in, data.
//
// The checksum and zstd's own would stop every change of a whole file: the other ways lead past
// them, to what is inside.
#include "server/scan/checkpoint_file.h"

#include "core/image/zstd_bytes.h"
#include "core/log/frame_log_format.h"
#include "tests/fuzz/checkpoint_conditions.h"

namespace {

using namespace hermite;

// A frame that states more is refused; the server believes more, behind the checksum.
constexpr std::size_t kMaxContentBytes = std::size_t{1} << 20;

bool same(const server::ScanCheckpoint& a, const server::ScanCheckpoint& b) {
  // Not every double is equal to itself: compared as bytes, by being written again.
  return a.scan_id == b.scan_id && a.pipeline == b.pipeline &&
         server::format_checkpoint(a) == server::format_checkpoint(b);
}

void parse(std::string_view bytes) {
  const Result<server::ScanCheckpoint> checkpoint = server::parse_checkpoint(bytes);
  if (!checkpoint.ok()) {
    CHECK(!checkpoint.error().message.empty(), "an error without words");
    return;
  }
  const Result<server::ScanCheckpoint> again =
      server::parse_checkpoint(server::format_checkpoint(*checkpoint));
  CHECK(again.ok() && same(*again, *checkpoint), "a checkpoint does not round-trip");
}

// As format_checkpoint() does with what a checkpoint has.
std::string wrapped(std::string_view content) {
  const std::string frame = image::compress_bytes(content);
  ByteWriter bytes;
  bytes.numbers("HRMSCNK1", 8);
  bytes.number(frame_log::crc32c(frame));
  bytes.numbers(frame.data(), frame.size());
  return bytes.take();
}

void unpack(std::string_view frame) {
  const Result<std::string> content = image::decompress_bytes(frame, kMaxContentBytes);
  if (!content.ok()) {
    CHECK(!content.error().message.empty(), "an error without words");
    return;
  }
  CHECK(content->size() <= kMaxContentBytes, "more than allowed");
}

void read(std::string_view head) {
  ByteReader bytes(head);
  const Status status = pipeline::read_head(bytes, fuzz::kConditions);
  CHECK(status.ok() ? bytes.ok() : !status.error().message.empty(), "read, and not read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 4) {
    case 0: parse(bytes); break;
    case 1: parse(wrapped(bytes)); break;
    case 2: unpack(bytes); break;
    default: read(bytes);
  }
  return 0;
}
