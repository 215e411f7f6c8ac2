// Single records of a frame log, found without reading what is before them (format: frame_log.md):
// every record has its number, so that the segment is found by halving and the record by going over
// the heads of those before it there, 64 MiB at most. For a log that nobody writes any more. What
// is damaged makes only itself unreadable, or what follows in its segment. Blocks on the disk;
// thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/log/frame_log_format.h"
#include "core/log/frame_log_reader.h"

namespace hermite::frame_log {

// The record of that number, its checksum proven. kNotFound: there is no log in the folder, or it
// ends before. kCorruptData: the record, or one before it in its segment, is damaged; the message
// names segment and byte. kIo.
Result<LogRecord> read_log_record(const std::string& folder, std::uint64_t number);

struct LogRecordHead {
  RecordType type = RecordType::kFrame;
  std::uint64_t number = 0;
  std::string_view beginning;  // of the payload; no checksum is proven
  // All of the record, with errors as above. Only while it is shown.
  std::function<Result<LogRecord>()> read;
};

// Shows all records to `visit`, in order, with at most so many bytes of each payload. Numbers are
// left out where a segment is damaged: it goes on with the next one. kNotFound: there is no log in
// the folder. kIo.
Status visit_log_records(const std::string& folder, std::size_t beginning_bytes,
                         const std::function<void(const LogRecordHead&)>& visit);

}  // namespace hermite::frame_log
