#include "server/client/server_url.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

namespace hermite::client {
namespace {

constexpr std::string_view kTokenKey = "token=";

std::optional<std::uint16_t> parse_port(std::string_view text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > 65535)
    return std::nullopt;
  return static_cast<std::uint16_t>(value);
}

bool is_host_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_';
}

bool is_ipv6_character(char c) {
  return std::isxdigit(static_cast<unsigned char>(c)) || c == ':' || c == '.' || c == '%';
}

// Parses "host", "host:port", "[v6]" or "[v6]:port" into `url`. Returns what is wrong, empty on
// success.
std::string parse_authority(std::string_view authority, ServerUrl& url) {
  std::string_view host, port;
  bool has_port = false;
  if (!authority.empty() && authority.front() == '[') {
    const std::size_t close = authority.find(']');
    if (close == std::string_view::npos) return "the [ has no ]";
    host = authority.substr(1, close - 1);
    if (!std::all_of(host.begin(), host.end(), is_ipv6_character))
      return "no IPv6 address between [ and ]";
    const std::string_view rest = authority.substr(close + 1);
    if (!rest.empty() && rest.front() != ':') return "only a :port may follow the ]";
    has_port = !rest.empty();
    port = has_port ? rest.substr(1) : rest;
  } else {
    const std::size_t colon = authority.find(':');
    host = authority.substr(0, colon);
    if (!std::all_of(host.begin(), host.end(), is_host_character))
      return "the host has characters that a host cannot have";
    has_port = colon != std::string_view::npos;
    if (has_port) port = authority.substr(colon + 1);
  }
  if (host.empty()) return "there is no host";
  if (has_port) {
    const auto number = parse_port(port);
    if (!number) return "the port must be a number from 1 to 65535";
    url.port = *number;
  }
  url.host = host;
  return {};
}

// Returns the value of "token" in "a=b&c=d"; empty if there is none.
std::string token_of(std::string_view fragment) {
  while (!fragment.empty()) {
    const std::size_t end = std::min(fragment.find('&'), fragment.size());
    const std::string_view pair = fragment.substr(0, end);
    if (pair.starts_with(kTokenKey)) return std::string(pair.substr(kTokenKey.size()));
    fragment.remove_prefix(std::min(end + 1, fragment.size()));
  }
  return {};
}

}  // namespace

std::string ServerUrl::host_and_port() const {
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return fmt::format("{}:{}", is_ipv6 ? fmt::format("[{}]", host) : host, port);
}

Result<ServerUrl> parse_server_url(const std::string& text) {
  const std::size_t hash = std::min(text.find('#'), text.size());
  const std::string shown = text.substr(0, hash);  // messages must not contain the token
  const auto failure = [&](const std::string& message) -> Result<ServerUrl> {
    return Error{ErrorCode::kInvalidArgument, fmt::format("server URL \"{}\": {}", shown, message)};
  };
  const std::size_t scheme_end = shown.find("://");
  const std::string scheme = shown.substr(0, scheme_end);
  ServerUrl url;
  url.tls = scheme == "https" || scheme == "wss";
  if (scheme_end == std::string::npos || (!url.tls && scheme != "http" && scheme != "ws"))
    return failure("expected https://HOST:PORT, http://HOST:PORT, or the same with wss and ws");
  url.port = url.tls ? 443 : 80;
  const std::string_view rest = std::string_view(shown).substr(scheme_end + 3);
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  const std::string_view path = rest.substr(slash);
  if (!path.empty() && path != "/")
    return failure("nothing may follow the port but / and #token=…");
  const std::string message = parse_authority(rest.substr(0, slash), url);
  if (!message.empty()) return failure(message);
  if (hash < text.size()) url.token = token_of(std::string_view(text).substr(hash + 1));
  return url;
}

}  // namespace hermite::client
