#include "server/client/api_request.h"

#include <utility>

namespace hermite::client {

Result<std::string> api_request(const ServerUrl& server, const std::string& method,
                                const std::string& path, const std::string& body) {
  server::TlsContext tls;
  if (server.tls) {
    Result<server::TlsContext> made = server::unverified_client_tls();
    if (!made.ok()) return made.error();
    tls = *std::move(made);
  }
  return accepted_body(server, tls, false, {method, path, {}, body});
}

}  // namespace hermite::client
