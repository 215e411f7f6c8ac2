// Who is on the other side of a connection, directly or behind a proxy that is trusted. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// An IPv6 address and how many of its bits count; IPv4 as ::ffff:a.b.c.d.
struct Network {
  std::array<std::uint8_t, 16> address{};
  int prefix_bits = 128;
};

// "10.0.0.0/8", "192.0.2.7", "fd00::/8". kInvalidArgument naming the text.
Result<Network> parse_network(const std::string& text);

// False for a text that is no address.
bool lies_in(const Network& network, std::string_view address);
bool lies_in_any(const std::vector<Network>& networks, std::string_view address);

struct Peer {
  std::string address;     // as the proxy says when it is a trusted one
  bool encrypted = false;  // TLS up to this server or its proxy
};

// `address` and `tls` are those of the connection itself, the other two the values of X-Forwarded-For and X-Forwarded-Proto (several
// headers joined by commas, empty without), which count only when a trusted proxy has sent them. Of the addresses named there, the last
// that is no trusted proxy is the client: those before it may be anything a client has made up. A port behind an address is left out, and
// each address has one text.
Peer peer_of(const std::string& address, bool tls, const std::vector<Network>& proxies, std::string_view forwarded_for,
             std::string_view forwarded_proto);

}  // namespace hermite
