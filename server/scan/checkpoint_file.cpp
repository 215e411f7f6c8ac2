#include "server/scan/checkpoint_file.h"

#include <fmt/core.h>

#include "core/base/byte_stream.h"
#include "core/image/zstd_bytes.h"
#include "core/log/frame_log_format.h"

namespace hermite::server {

namespace {

constexpr std::string_view kMagic = "HRMSCNK1";
constexpr std::size_t kHeaderBytes = 12;

template <class Bytes, class Saved>
void fields(Bytes& bytes, Saved& checkpoint) {
  bytes.text(checkpoint.scan_id);
  bytes.number(checkpoint.record_count);
  bool has_tracked = checkpoint.last_tracked.has_value();
  bytes.flag(has_tracked);
  wire::TrackedFrame tracked = checkpoint.last_tracked.value_or(wire::TrackedFrame{});
  bytes.number(tracked.sequence);
  bytes.number(tracked.timestamp_s);
  if constexpr (!std::is_const_v<Saved>)
    checkpoint.last_tracked = has_tracked ? std::optional(tracked) : std::nullopt;
  bytes.text(checkpoint.pipeline);
}

}  // namespace

std::string format_checkpoint(const ScanCheckpoint& checkpoint) {
  ByteWriter content;
  fields(content, checkpoint);
  const std::string frame = image::compress_bytes(content.take());
  ByteWriter bytes;
  bytes.numbers(kMagic.data(), kMagic.size());
  bytes.number(frame_log::crc32c(frame));
  bytes.numbers(frame.data(), frame.size());
  return bytes.take();
}

Result<ScanCheckpoint> parse_checkpoint(std::string_view bytes) {
  if (!bytes.starts_with(kMagic) || bytes.size() < kHeaderBytes)
    return Error{ErrorCode::kCorruptData, "no checkpoint, or one of another format"};
  ByteReader header(bytes.substr(kMagic.size()));
  std::uint32_t crc = 0;
  header.number(crc);
  const std::string_view frame = bytes.substr(kHeaderBytes);
  if (crc != frame_log::crc32c(frame))
    return Error{ErrorCode::kCorruptData,
                 "the checkpoint is cut or damaged: its checksum does not fit"};
  const Result<std::string> content = image::decompress_bytes(frame, kMaxCheckpointBytes);
  if (!content.ok()) return content.error();
  ByteReader reader(*content);
  ScanCheckpoint checkpoint;
  fields(reader, checkpoint);
  reader.require(reader.at_end(), "more than a checkpoint");
  if (!reader.ok()) return reader.status().error();
  return checkpoint;
}

Result<ScanCheckpoint> read_checkpoint(Blobs& blobs, const std::string& scan_id,
                                       std::uint64_t log_record_count) {
  const Result<std::string> bytes = read_blob(blobs, scan_id, kCheckpointName, kMaxCheckpointBytes);
  if (!bytes.ok()) return bytes.error();
  Result<ScanCheckpoint> checkpoint = parse_checkpoint(*bytes);
  if (!checkpoint.ok()) return checkpoint;
  if (checkpoint->scan_id != scan_id)
    return Error{ErrorCode::kCorruptData, "the checkpoint is of scan " + checkpoint->scan_id};
  if (checkpoint->record_count > log_record_count)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("the checkpoint is of {} records of the frame log, which has only {}",
                             checkpoint->record_count, log_record_count)};
  return checkpoint;
}

}  // namespace hermite::server
