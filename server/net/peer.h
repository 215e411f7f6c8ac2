// Determines the client of a connection, directly or behind a trusted proxy. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// An IPv6 address and the length of its prefix; IPv4 as ::ffff:a.b.c.d.
struct Network {
  std::array<std::uint8_t, 16> address{};
  int prefix_bits = 128;
};

// Parses "10.0.0.0/8", "192.0.2.7", "fd00::/8". kInvalidArgument naming the text.
Result<Network> parse_network(const std::string& text);

// Returns false for a text that is not an address.
bool lies_in(const Network& network, std::string_view address);
bool lies_in_any(const std::vector<Network>& networks, std::string_view address);

struct Peer {
  std::string address;     // as given by the proxy, if that is trusted
  bool encrypted = false;  // by TLS up to this server or its proxy
};

// `address` and `tls` are those of the connection itself; the other two are the values of
// X-Forwarded-For and X-Forwarded-Proto (several headers joined by commas, empty if missing), which
// are used only if a trusted proxy has sent them. The client is the last address in X-Forwarded-For
// that is not a trusted proxy, since a client can forge those before it. A port after an address is
// removed, and each address is normalised to one text.
Peer peer_of(const std::string& address, bool tls, const std::vector<Network>& proxies,
             std::string_view forwarded_for, std::string_view forwarded_proto);

}  // namespace hermite::server
