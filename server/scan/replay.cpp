#include "server/scan/replay.h"

#include <utility>

#include "proto/wire/client_message.h"

namespace hermite::server {

Result<std::optional<wire::Frame>> Replay::next() {
  while (reader_.end().record_count < record_count_) {
    Result<std::optional<frame_log::LogRecord>> record = reader_.next();
    if (!record.ok()) return record.error();
    if (!*record)
      return Error{ErrorCode::kCorruptData,
                   "the frame log has become shorter: " + reader_.end().message};
    if ((*record)->type != frame_log::RecordType::kFrame) continue;
    Result<wire::Frame> frame =
        wire::parse_frame_message((*record)->payload, frame_log::kMaxRecordBytes);
    if (!frame.ok()) return in_context("a record of the frame log", frame.error());
    return std::optional<wire::Frame>(*std::move(frame));
  }
  return std::optional<wire::Frame>();
}

Result<std::uint64_t> Replay::skip(std::uint64_t record_count) {
  std::uint64_t refused_count = 0;
  while (reader_.end().record_count < record_count) {
    const Result<std::optional<frame_log::LogRecord>> record = reader_.next();
    if (!record.ok()) return record.error();
    if (!*record)
      return Error{ErrorCode::kCorruptData,
                   "the frame log has become shorter: " + reader_.end().message};
    refused_count += (*record)->type == frame_log::RecordType::kRefusedFrame ? 1 : 0;
  }
  return refused_count;
}

}  // namespace hermite::server
