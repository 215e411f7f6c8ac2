// One HTTP request and its answer, over a connection of its own. Blocks; a minute without progress is an error.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite {

inline constexpr std::size_t kMaxApiAnswerBytes = 16 * 1024 * 1024;

struct HttpCall {
  std::string method;
  std::string path;
  std::vector<std::pair<std::string, std::string>> headers;  // besides Host, Connection, Authorization and Content-Length
  std::string body;
};

struct HttpReply {
  int status = 0;
  std::string header;  // all of it, with its first line
  std::string body;

  std::optional<std::string> field(const std::string& name) const;  // of the header, in any case
};

// Any answer is well, whatever its status. kIo: no connection, or the answer was cut. Without `tls` nothing is encrypted; with `check_name`
// the certificate must have the server's name. Words never contain the token.
Result<HttpReply> http_exchange(const ServerUrl& server, const TlsContext& tls, bool check_name, const HttpCall& call);

// What a server says that refuses something: its words, as kNotFound (404, 410), kUnauthorized (401, 403), kBusy (409, 423, 429, 503),
// kTooLarge (413), kInvalidArgument (other 4xx) or kIo.
Error refusal(const HttpReply& reply);

}  // namespace hermite
