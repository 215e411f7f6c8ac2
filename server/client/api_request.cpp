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
  HttpCall call{method, path, {}, body};
  if (!body.empty()) call.headers.emplace_back("Content-Type", "application/json");
  Result<HttpReply> reply = http_exchange(server, tls, false, call);
  if (!reply.ok()) return reply.error();
  if (reply->status >= 300) return refusal(*reply);
  return std::move(reply->body);
}

}  // namespace hermite
