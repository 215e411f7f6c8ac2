// The checkpoint of a scan on disk, so that the next server need not process all of its frames
// again. It can always be discarded, since it can be made again from the frame log. Little endian:
//
//   "HRMSCNK1", u32 CRC-32C of all that follows, one zstd frame of:
//   text scan id, u64 record_count, flag and u64 sequence, f64 time of the last tracked frame,
//       bytes of the pipeline (byte_stream.h)
//
// Pure functions, but for the last.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/store/blobs.h"

namespace hermite::server {

inline constexpr const char* kCheckpointName = "checkpoint.bin";  // name of the blob

// The largest map (65,535 blocks) takes 0.7 GB on the device. A longer file is invalid and must not
// exhaust the memory.
inline constexpr std::size_t kMaxCheckpointBytes = std::size_t{4} * 1024 * 1024 * 1024;

// Records of a frame log that precede the frames.
inline constexpr std::uint64_t kRecordsBeforeFrames = 2;

struct ScanCheckpoint {
  std::string scan_id;
  std::uint64_t record_count = 0;  // how many records of the frame log it includes
  std::optional<wire::TrackedFrame> last_tracked;
  std::string pipeline;  // Pipeline::save()
};

std::string format_checkpoint(const ScanCheckpoint& checkpoint);

// kCorruptData or kTooLarge, with a message.
Result<ScanCheckpoint> parse_checkpoint(std::string_view bytes);

// Reads the checkpoint of a scan whose frame log has `record_count` records; blocks on storage.
// kNotFound: there is none. kCorruptData: also when it belongs to another scan or includes more
// records than the log has. kTooLarge, kIo.
Result<ScanCheckpoint> read_checkpoint(Blobs& blobs, const std::string& scan_id,
                                       std::uint64_t log_record_count);

}  // namespace hermite::server
