// One request to a server's HTTP API, for programs on the same machine: blocks until the answer is there, a minute at most. With TLS the
// certificate is not verified: it has the name that others use, and nothing leaves the machine.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/client/server_url.h"

namespace hermite {

inline constexpr std::size_t kMaxApiAnswerBytes = 16 * 1024 * 1024;

// The body of an answer of 2xx. `body` is JSON or empty. kIo: no connection, or the answer was cut. Other failures are the server's, in its
// words: kNotFound (404), kUnauthorized (401, 403), kBusy (409, 429, 503), kInvalidArgument (other 4xx). Words never contain the token.
Result<std::string> api_request(const ServerUrl& server, const std::string& method, const std::string& path, const std::string& body);

}  // namespace hermite
