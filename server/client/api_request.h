// One request to a server's HTTP API: blocks until the answer has arrived, or there was no progress
// for a minute.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/client/http_exchange.h"
#include "server/client/server_url.h"

namespace hermite::client {

// For a program on the same machine: with TLS the certificate is not verified, because it has the
// server's public name, and nothing leaves the machine. `body` is JSON or empty. Returns the body
// of an answer with status 2xx. Errors as http_exchange() and, with the server's message,
// refusal().
Result<std::string> api_request(const ServerUrl& server, const std::string& method,
                                const std::string& path, const std::string& body);

}  // namespace hermite::client
