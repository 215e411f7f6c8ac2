// Where a server is and how to be let in, from what a person pastes: "http://127.0.0.1:8080", "wss://host:8080", "https://host",
// or the address as the server prints it, "http://127.0.0.1:8080/#token=…". Plain value, pure function.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite {

struct ServerUrl {
  std::string host;         // a name or an address, IPv6 without its brackets
  std::uint16_t port = 80;  // 443 with TLS
  std::string token;        // empty when the text has none
  bool tls = false;         // https:// or wss://

  // "127.0.0.1:8080", "[::1]:8080": the Host header, and words for a person. Never contains the token.
  std::string host_and_port() const;
  bool operator==(const ServerUrl&) const = default;
};

// kInvalidArgument, naming the text without its token: no http(s):// or ws(s)://, no host, a port outside 1 to 65535, a path other than
// "/".
Result<ServerUrl> parse_server_url(const std::string& text);

}  // namespace hermite
