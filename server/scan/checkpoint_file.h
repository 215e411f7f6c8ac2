// What a scan has come to, on disk, so that a server that comes after this one need not work through all of its frames again. It can always
// be thrown away: the frame log is the truth. Little endian:
//
//   "HRMSCNK1", u32 CRC-32C of all that follows, one zstd frame of:
//   text scan id, u64 record_count, flag and u64 sequence, f64 time of the last tracked frame, bytes of the pipeline (byte_stream.h)
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

namespace hermite {

inline constexpr const char* kCheckpointName = "checkpoint.bin";  // of the blob

// The largest map (65,535 blocks) has 0.7 GB on the device; what is longer is none of ours and must not take all memory.
inline constexpr std::size_t kMaxCheckpointBytes = std::size_t{4} * 1024 * 1024 * 1024;

inline constexpr std::uint64_t kRecordsBeforeFrames = 2;  // of a frame log

struct ScanCheckpoint {
  std::string scan_id;
  std::uint64_t record_count = 0;  // the first so many of the frame log are in it
  std::optional<wire::TrackedFrame> last_tracked;
  std::string pipeline;  // Pipeline::save()
};

std::string format_checkpoint(const ScanCheckpoint& checkpoint);

// kCorruptData or kTooLarge, in words.
Result<ScanCheckpoint> parse_checkpoint(std::string_view bytes);

// That of the scan, whose frame log has so many records; waits for where it is kept. kNotFound: there is none. kCorruptData, also when it
// is of another scan or of more records than there are. kTooLarge, kIo.
Result<ScanCheckpoint> read_checkpoint(Blobs& blobs, const std::string& scan_id, std::uint64_t log_record_count);

}  // namespace hermite
