// A request to a server whose answer is a JSON object.
#pragma once

#include <nlohmann/json.hpp>

#include "server/client/http_exchange.h"

namespace hermite::client {

// Blocks as http_exchange() does. `call.body` is JSON or empty. Errors as http_exchange() and
// refusal(), and kIo for an answer that is not a JSON object.
Result<nlohmann::ordered_json> json_call(const ServerUrl& server, const server::TlsContext& tls,
                                         HttpCall call);

// Return the member of that name if it is a string or an integer; otherwise an empty text or 0.
std::string text_member(const nlohmann::ordered_json& object, const char* name);
std::int64_t integer_member(const nlohmann::ordered_json& object, const char* name);

}  // namespace hermite::client
