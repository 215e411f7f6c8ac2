#include "server/net/peer.h"

#include <arpa/inet.h>
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

namespace hermite::server {

namespace {

using Address = std::array<std::uint8_t, 16>;
constexpr int kMappedBits = 96;  // length of the prefix of IPv4 addresses mapped into IPv6

std::optional<Address> parse_address(std::string_view text, bool& is_v4) {
  char buffer[INET6_ADDRSTRLEN];
  if (text.empty() || text.size() >= sizeof buffer) return std::nullopt;
  std::memcpy(buffer, text.data(), text.size());
  buffer[text.size()] = 0;
  Address address{};
  is_v4 = inet_pton(AF_INET, buffer, address.data() + 12) == 1;
  if (is_v4) {
    address[10] = address[11] = 0xff;
    return address;
  }
  if (inet_pton(AF_INET6, buffer, address.data()) != 1) return std::nullopt;
  return address;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

// Returns the part after the last comma, and removes it from `list`.
std::string_view take_last(std::string_view& list) {
  const std::size_t comma = list.rfind(',');
  const std::string_view last =
      trimmed(comma == std::string_view::npos ? list : list.substr(comma + 1));
  list = comma == std::string_view::npos ? std::string_view() : list.substr(0, comma);
  return last;
}

// Some proxies append the client's port to its address: 192.0.2.7:1234, [2001:db8::1]:1234.
std::string_view without_port(std::string_view text) {
  if (text.starts_with('[')) return text.substr(1, text.find(']') - 1);
  const std::size_t colon = text.find(':');
  return colon == text.rfind(':') ? text.substr(0, colon) : text;
}

// Returns the same text for an address however it was written, so that no client counts as two.
std::string text_of(const Address& address) {
  static constexpr Address kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  const bool is_v4 =
      std::equal(address.begin(), address.begin() + kMappedBits / 8, kMapped.begin());
  char text[INET6_ADDRSTRLEN] = "";
  inet_ntop(is_v4 ? AF_INET : AF_INET6, address.data() + (is_v4 ? kMappedBits / 8 : 0), text,
            sizeof text);
  return text;
}

}  // namespace

Result<Network> parse_network(const std::string& text) {
  const Error error{
      ErrorCode::kInvalidArgument,
      fmt::format("\"{}\" is no address or network: expected for example 192.0.2.7 or 10.0.0.0/8",
                  text)};
  const std::size_t slash = std::min(text.find('/'), text.size());
  bool is_v4 = false;
  const std::optional<Address> address =
      parse_address(std::string_view(text).substr(0, slash), is_v4);
  if (!address) return error;
  Network network{*address, 128};
  if (slash == text.size()) return network;
  int bits = -1;
  const auto [stop, wrong] =
      std::from_chars(text.data() + slash + 1, text.data() + text.size(), bits);
  if (wrong != std::errc() || stop != text.data() + text.size() || bits < 0 ||
      bits > (is_v4 ? 32 : 128))
    return error;
  network.prefix_bits = bits + (is_v4 ? kMappedBits : 0);
  return network;
}

bool lies_in(const Network& network, std::string_view text) {
  bool is_v4 = false;
  const std::optional<Address> address = parse_address(text, is_v4);
  if (!address) return false;
  for (int bit = 0; bit < network.prefix_bits; ++bit) {
    const auto byte = static_cast<std::size_t>(bit / 8);
    if (((network.address[byte] ^ (*address)[byte]) >> (7 - bit % 8) & 1) != 0) return false;
  }
  return true;
}

bool lies_in_any(const std::vector<Network>& networks, std::string_view address) {
  return std::any_of(networks.begin(), networks.end(),
                     [address](const Network& network) { return lies_in(network, address); });
}

Peer peer_of(const std::string& address, bool tls, const std::vector<Network>& proxies,
             std::string_view forwarded_for, std::string_view forwarded_proto) {
  Peer peer{address, tls};
  if (!lies_in_any(proxies, address)) return peer;
  // The proxy nearest to this server wrote the last value.
  if (!forwarded_proto.empty()) peer.encrypted = take_last(forwarded_proto) == "https";
  while (!forwarded_for.empty()) {
    bool is_v4 = false;
    const std::optional<Address> named =
        parse_address(without_port(take_last(forwarded_for)), is_v4);
    if (!named) break;
    peer.address = text_of(*named);
    if (!lies_in_any(proxies, peer.address)) break;
  }
  return peer;
}

}  // namespace hermite::server
