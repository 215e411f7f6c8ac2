// Who may talk to the server: tokens, Host and Origin headers, listening addresses. Pure functions.
//
// A page of any web site can make a browser connect to 127.0.0.1; its Host (after DNS rebinding) or Origin header gives it away.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// In a time that depends on the lengths only.
bool tokens_equal(std::string_view a, std::string_view b);

// Names without port, lower case: "localhost", "127.0.0.1", "[::1]" and what the operator adds.
using AllowedHosts = std::vector<std::string>;
AllowedHosts default_hosts();

// `host` as in a Host header: a name with or without a port.
bool host_allowed(const AllowedHosts& allowed, std::string_view host);

// `origin` as in an Origin header: "http://name:port" or https. "null" is never allowed.
bool origin_allowed(const AllowedHosts& allowed, std::string_view origin);

// Whose allowance an address uses up, from its text: an IPv4 address its own, an IPv6 address its network's ("2001:db8:1:2::/64", since one
// customer has all of that), an IPv4 address mapped into IPv6 that of the IPv4 address. Other text is returned as it is.
std::string address_group(const std::string& address);

struct ListenAddress {
  std::string host;  // an IP address, IPv6 without brackets
  std::uint16_t port = 0;
};

// "127.0.0.1:8080" or "[::1]:8080"; "localhost" means 127.0.0.1. kInvalidArgument naming the text.
Result<ListenAddress> parse_listen_address(const std::string& text);

bool is_loopback(const ListenAddress& address);

// "http://127.0.0.1:8080"
std::string url_of(const ListenAddress& address);

}  // namespace hermite
