// One request to a server's HTTP API: blocks until the answer is there, or nothing has moved for a minute.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/client/http_exchange.h"
#include "server/client/server_url.h"

namespace hermite {

// Of a program on the same machine: with TLS the certificate is not verified, because it has the name that others use, and nothing leaves
// the machine. The body of an answer of 2xx. `body` is JSON or empty. Failures are those of http_exchange() and, in the server's words,
// refusal().
Result<std::string> api_request(const ServerUrl& server, const std::string& method, const std::string& path, const std::string& body);

}  // namespace hermite
