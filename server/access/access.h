// Basic checks of access: comparison of tokens, Host and Origin headers, listening addresses. Pure
// functions.
//
// A page of any web site can make a browser connect to 127.0.0.1; its Host header (after DNS
// rebinding) or its Origin header reveals that.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// Takes a time that depends only on the lengths.
bool tokens_equal(std::string_view a, std::string_view b);

// Host names without port, in lower case: "localhost", "127.0.0.1", "[::1]" and those that the
// operator adds.
using AllowedHosts = std::vector<std::string>;
AllowedHosts default_hosts();

// `host` is the value of a Host header: a name with or without a port.
bool host_allowed(const AllowedHosts& allowed, std::string_view host);

// `origin` is the value of an Origin header: "http://name:port" or https. "null" is never allowed.
bool origin_allowed(const AllowedHosts& allowed, std::string_view origin);

// The frame-ancestors of pages that no site may embed.
inline constexpr std::string_view kNoFrames = "'none'";

// Returns the sources of a Content-Security-Policy's frame-ancestors: 'none' without sites. A site
// is "https://HOST", "http://HOST", with or without a port, where HOST may begin with "*." for all
// below a name; or "*", any site. kInvalidArgument naming the site. The text has no characters that
// could end the directive or the header.
Result<std::string> frame_ancestors(const std::vector<std::string>& sites);

// Returns the key under which limits count an address: an IPv4 address itself; for an IPv6 address
// its network ("2001:db8:1:2::/64", since one customer has all of it); for an IPv4 address mapped
// into IPv6 the IPv4 address. Other text is returned unchanged.
std::string address_group(const std::string& address);

struct ListenAddress {
  std::string host;  // an IP address; IPv6 without brackets
  std::uint16_t port = 0;
};

// Parses "127.0.0.1:8080" or "[::1]:8080"; "localhost" means 127.0.0.1. kInvalidArgument naming the
// text.
Result<ListenAddress> parse_listen_address(const std::string& text);

bool is_loopback(const ListenAddress& address);

// Returns for example "http://127.0.0.1:8080".
std::string url_of(const ListenAddress& address);

}  // namespace hermite::server
