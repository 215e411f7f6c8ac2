// ServerMessage: bytes to value and back. Pure and thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"
#include "proto/wire/messages.h"

namespace hermite::wire {

// As parse_client_message: unknown bodies are values, errors name the field. Poses are finite with
// unit quaternions.
Result<ServerMessage> parse_server_message(std::string_view bytes,
                                           std::size_t max_bytes = kMaxServerMessageBytes);

std::string format_server_message(ServerMessage message);

}  // namespace hermite::wire
