#include "server/client/api_request.h"

#include <utility>

namespace hermite {

Result<std::string> api_request(const ServerUrl& server, const std::string& method, const std::string& path, const std::string& body) {
  TlsContext tls;
  if (server.tls) {
    Result<TlsContext> made = unverified_client_tls();
    if (!made.ok()) return made.error();
    tls = *std::move(made);
  }
  return accepted_body(server, tls, false, {method, path, {}, body});
}

}  // namespace hermite
