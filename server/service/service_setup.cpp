#include "server/service/service_setup.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <boost/asio/ip/address.hpp>
#include <chrono>
#include <cstdint>

#include "server/database/postgres_connection.h"
#include "server/service/settings.h"
#include "server/store/rows_place.h"

namespace hermite::server {

namespace asio = boost::asio;

ServiceOptions checked(const ServiceOptions& options) {
  if (const Status status = check(options); !status.ok()) throw SetupError(status.error());
  return options;
}

ListenAddress checked_address(const ServiceOptions& options) {
  const ListenAddress address = or_throw(parse_listen_address(options.listen));
  const bool protected_somehow = !options.tls_certificate.empty() ||
                                 !options.trusted_proxies.empty() || options.insecure_listen;
  if (!is_loopback(address) && !protected_somehow)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         fmt::format("--listen {} is reachable from other machines and the connection is not "
                     "encrypted: give --tls-certificate and --tls-key, or name the proxy that ends "
                     "TLS with --trusted-proxy, or listen on 127.0.0.1, or add --insecure-i-know",
                     options.listen)});
  return address;
}

std::optional<ListenAddress> checked_admin_address(const ServiceOptions& options) {
  if (options.admin_listen == "off") return std::nullopt;
  const Result<ListenAddress> address = parse_listen_address(options.admin_listen);
  if (!address.ok()) throw SetupError(in_context("--admin-listen", address.error()));
  if (!is_loopback(*address) && !options.insecure_listen)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         fmt::format("--admin-listen {} is reachable from other machines, and whoever reaches it "
                     "needs no token: take a loopback address, or add --insecure-i-know",
                     options.admin_listen)});
  return *address;
}

std::unique_ptr<Database> opened_rows(const ServiceOptions& options) {
  if (!options.database.empty())
    if (const Status allowed = check_postgres_url(options.database, options.insecure_listen);
        !allowed.ok())
      throw SetupError(in_context("setting database", allowed.error()));
  return open_rows(options.data_folder, options.database);
}

std::string frame_ancestors_of(const ServiceOptions& options) {
  Result<std::string> ancestors = frame_ancestors(options.embed_in);
  if (!ancestors.ok()) throw SetupError(in_context("--embed-in", ancestors.error()));
  return *std::move(ancestors);
}

std::vector<Network> proxies_of(const ServiceOptions& options) {
  std::vector<Network> networks;
  for (const std::string& text : options.trusted_proxies) {
    const Result<Network> network = parse_network(text);
    if (!network.ok()) throw SetupError(in_context("--trusted-proxy", network.error()));
    networks.push_back(*network);
  }
  return networks;
}

TlsContext tls_of(const ServiceOptions& options) {
  return options.tls_certificate.empty()
             ? nullptr
             : or_throw(server_tls(options.tls_certificate, options.tls_key));
}

ScansOptions scans_options(const ServiceOptions& options) {
  return {options.device,
          {options.max_scans, options.scans_per_token, options.live_rate_hz,
           static_cast<std::uint64_t>(options.gpu_memory_mb) * 1'000'000},
          static_cast<std::uint32_t>(options.credit_window),
          options.gpu_memory_mb,
          std::chrono::seconds(options.resume_window_s),
          std::chrono::seconds(options.frame_patience_s),
          static_cast<std::uint64_t>(options.min_free_disk_mb) * 1'000'000,
          options.keep_log_days,
          std::chrono::milliseconds(options.checkpoint_period_ms)};
}

UploadLimits upload_limits(const ServiceOptions& options) {
  constexpr std::int64_t kGigabyte = 1'000'000'000;
  return {options.max_upload_gb * kGigabyte, options.uploads_per_token_gb * kGigabyte,
          static_cast<std::uint64_t>(options.min_free_disk_mb) * 1'000'000,
          options.keep_upload_hours * 3'600'000LL};
}

AllowedHosts allowed_hosts(const ServiceOptions& options, const ListenAddress& address) {
  AllowedHosts hosts = default_hosts();
  hosts.push_back(address.host.find(':') == std::string::npos ? address.host
                                                              : fmt::format("[{}]", address.host));
  hosts.insert(hosts.end(), options.allow_hosts.begin(), options.allow_hosts.end());
  return hosts;
}

StaticFiles viewer_files(const std::string& folder) {
  Result<StaticFiles> files = read_static_files(folder);
  if (files.ok()) return *std::move(files);
  spdlog::warn("no web viewer: {}", files.error().message);
  return {};
}

asio::ip::tcp::acceptor open_port(asio::io_context& context, const ListenAddress& address) {
  using asio::ip::tcp;
  boost::system::error_code error;
  const tcp::endpoint endpoint(asio::ip::make_address(address.host, error), address.port);
  tcp::acceptor acceptor(context);
  if (!error) acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw SetupError(
        {ErrorCode::kIo, fmt::format("listening on {}: {}", url_of(address), error.message())});
  return acceptor;
}

}  // namespace hermite::server
