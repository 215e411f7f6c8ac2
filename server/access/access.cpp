#include "server/access/access.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace hermite::server {

namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

struct HostAndPort {
  std::string_view host;  // IPv6 with its brackets
  std::string_view port;  // digits, perhaps empty
};

// Returns std::nullopt if the text is not "host" or "host:port".
std::optional<HostAndPort> split_host(std::string_view text) {
  std::size_t end = 0;
  if (!text.empty() && text.front() == '[') {
    end = text.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    ++end;
  } else {
    end = std::min(text.find(':'), text.size());
  }
  const std::string_view host = text.substr(0, end), rest = text.substr(end);
  if (host.empty() || rest == ":") return std::nullopt;
  if (rest.empty()) return HostAndPort{host, {}};
  const std::string_view port = rest.substr(1);
  if (rest.front() != ':' || port.size() > 5 ||
      port.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  return HostAndPort{host, port};
}

}  // namespace

bool tokens_equal(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

AllowedHosts default_hosts() { return {"localhost", "127.0.0.1", "[::1]"}; }

bool host_allowed(const AllowedHosts& allowed, std::string_view host) {
  const std::optional<HostAndPort> parts = split_host(host);
  return parts && std::find(allowed.begin(), allowed.end(), lower(parts->host)) != allowed.end();
}

bool origin_allowed(const AllowedHosts& allowed, std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.substr(0, scheme.size()) == scheme)
      return host_allowed(allowed, origin.substr(scheme.size()));
  return false;
}

std::string address_group(const std::string& address) {
  in6_addr v6{};
  if (inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &v6) != 1) return address;
  char text[INET6_ADDRSTRLEN];
  if (IN6_IS_ADDR_V4MAPPED(&v6)) return inet_ntop(AF_INET, v6.s6_addr + 12, text, sizeof text);
  std::fill(v6.s6_addr + 8, v6.s6_addr + 16, std::uint8_t{0});
  return std::string(inet_ntop(AF_INET6, &v6, text, sizeof text)) + "/64";
}

Result<ListenAddress> parse_listen_address(const std::string& text) {
  const Error error{
      ErrorCode::kInvalidArgument,
      fmt::format(
          "listen address \"{}\": expected IP:PORT, for example 127.0.0.1:8080 or [::1]:8080",
          text)};
  const std::optional<HostAndPort> parts = split_host(text);
  if (!parts || parts->port.empty()) return error;
  unsigned int port = 0;
  std::from_chars(parts->port.data(), parts->port.data() + parts->port.size(), port);
  if (port > 65535) return error;
  ListenAddress address{lower(parts->host), static_cast<std::uint16_t>(port)};
  if (address.host == "localhost") address.host = "127.0.0.1";
  const bool bracketed = address.host.front() == '[';
  if (bracketed) address.host = address.host.substr(1, address.host.size() - 2);
  unsigned char binary[sizeof(in6_addr)];
  if (inet_pton(bracketed ? AF_INET6 : AF_INET, address.host.c_str(), binary) != 1) return error;
  return address;
}

bool is_loopback(const ListenAddress& address) {
  in_addr v4{};
  if (inet_pton(AF_INET, address.host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, address.host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

std::string url_of(const ListenAddress& address) {
  const bool v6 = address.host.find(':') != std::string::npos;
  return fmt::format("http://{}:{}", v6 ? fmt::format("[{}]", address.host) : address.host,
                     address.port);
}

namespace {

// "https://example.org:8443", "http://*.example.org": what a header may have without changing its
// meaning.
bool is_site(std::string_view site) {
  for (const std::string_view scheme : {"https://", "http://"}) {
    if (!site.starts_with(scheme)) continue;
    std::string_view host = site.substr(scheme.size());
    if (host.starts_with("*.")) host.remove_prefix(2);
    const std::size_t colon = host.find(':');
    const std::string_view port = colon == std::string_view::npos ? "1" : host.substr(colon + 1);
    host = host.substr(0, colon);
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_of_name = [&](char c) {
      return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
             c == '.';
    };
    return !host.empty() && std::all_of(host.begin(), host.end(), is_of_name) && !port.empty() &&
           port.size() <= 5 && std::all_of(port.begin(), port.end(), is_digit);
  }
  return false;
}

}  // namespace

Result<std::string> frame_ancestors(const std::vector<std::string>& sites) {
  std::string sources;
  for (const std::string& site : sites) {
    if (site != "*" && !is_site(site))
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("'{}' is no site: allowed are https://HOST and http://HOST, with or "
                               "without a port and *. before HOST, and *",
                               site)};
    sources += (sources.empty() ? "" : " ") + site;
  }
  return sources.empty() ? std::string(kNoFrames) : sources;
}

}  // namespace hermite::server
