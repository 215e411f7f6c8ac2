// ClientMessage: bytes to value and back. Pure and thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "proto/wire/messages.h"

namespace hermite::wire {

// Takes no more memory than a small multiple of `max_bytes`. A message whose body is not known is
// Unknown, not an error. kTooLarge: more than `max_bytes`. kCorruptData: not a ClientMessage (cut,
// garbage, text that is not UTF-8). kInvalidArgument, kUnsupported or kTooLarge, naming field and
// limit: a field breaks a rule of messages.h.
Result<ClientMessage> parse_client_message(std::string_view bytes, std::size_t max_bytes);

// The same of one that must be a frame, as the records of a frame log are: kCorruptData otherwise.
Result<Frame> parse_frame_message(std::string_view bytes, std::size_t max_bytes);

// The time of a frame message of which only the beginning is there, in seconds, without looking at
// its images. None: it does not stand before these, as every encoder that keeps to the order of the
// fields has it, or these are no such bytes.
std::optional<double> frame_time_in(std::string_view beginning);
inline constexpr std::size_t kFrameTimeBytes = 48;  // of the beginning, where the time is

// The bytes of one message; Unknown gives an empty message.
std::string format_client_message(ClientMessage message);

}  // namespace hermite::wire
