// The address of a server and its token, as a person pastes them: "http://127.0.0.1:8080",
// "wss://host:8080", "https://host", or the address that the server prints,
// "http://127.0.0.1:8080/#token=…". Plain value, pure function.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::client {

struct ServerUrl {
  std::string host;         // a name or an address, IPv6 without its brackets
  std::uint16_t port = 80;  // default with TLS: 443
  std::string token;        // empty if the text has none
  bool tls = false;         // https:// or wss://

  // Returns "127.0.0.1:8080" or "[::1]:8080", for the Host header and for messages. Never contains
  // the token.
  std::string host_and_port() const;
  bool operator==(const ServerUrl&) const = default;
};

// kInvalidArgument, naming the text without its token: no http(s):// or ws(s)://, no host, a port
// outside 1 to 65535, a path other than "/".
Result<ServerUrl> parse_server_url(const std::string& text);

}  // namespace hermite::client
