// One HTTP request and its answer, over its own connection. Blocks; a minute without progress is an
// error.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite::client {

inline constexpr std::size_t kMaxApiAnswerBytes = 16 * 1024 * 1024;

struct HttpCall {
  std::string method;
  std::string path;
  // Besides Host, Connection, Authorization and Content-Length.
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
};

struct HttpReply {
  int status = 0;
  std::string header;  // complete, with the status line
  std::string body;

  // Returns a field of the header; the name is not case-sensitive.
  std::optional<std::string> field(const std::string& name) const;
};

// Returns any answer, whatever its status. kIo: no connection, or the answer was incomplete.
// Without `tls` nothing is encrypted; with `check_name` the certificate must be for the server's
// name. Messages never contain the token.
Result<HttpReply> http_exchange(const ServerUrl& server, const server::TlsContext& tls,
                                bool check_name, const HttpCall& call);

// The same for a call whose body is JSON or empty. Returns the body of an answer with status 2xx.
// Errors as http_exchange() and refusal().
Result<std::string> accepted_body(const ServerUrl& server, const server::TlsContext& tls,
                                  bool check_name, HttpCall call);

// Returns the error for an answer that refuses a request, with the server's message: kNotFound
// (404, 410), kUnauthorized (401, 403), kBusy (409, 423, 429, 503), kTooLarge (413),
// kInvalidArgument (other 4xx) or kIo.
Error refusal(const HttpReply& reply);

}  // namespace hermite::client
