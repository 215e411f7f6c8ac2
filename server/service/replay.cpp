#include "server/service/replay.h"

#include <utility>
#include <variant>

#include "proto/wire/client_message.h"

namespace hermite {

Result<std::optional<wire::Frame>> Replay::next() {
  while (reader_.end().record_count < record_count_) {
    Result<std::optional<LogRecord>> record = reader_.next();
    if (!record.ok()) return record.error();
    if (!*record) return Error{ErrorCode::kCorruptData, "the frame log has become shorter: " + reader_.end().words};
    if ((*record)->type != RecordType::kFrame) continue;
    Result<wire::ClientMessage> message = wire::parse_client_message((*record)->payload, kMaxRecordBytes);
    if (!message.ok()) return in_context("a record of the frame log", message.error());
    wire::Frame* const frame = std::get_if<wire::Frame>(&*message);
    if (!frame) return Error{ErrorCode::kCorruptData, "a record of the frame log is another message than a frame"};
    return std::optional<wire::Frame>(std::move(*frame));
  }
  return std::optional<wire::Frame>();
}

}  // namespace hermite
