#include "server/service/service.h"

#include <spdlog/spdlog.h>

#include <utility>  // before asio/awaitable.hpp, see websocket.h

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <optional>

#include "server/service/access.h"
#include "server/service/gate.h"
#include "server/service/http_connection.h"
#include "server/service/rate_limit.h"
#include "server/service/scans.h"
#include "server/service/static_files.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kStopPatience(60);  // for the frame in work and the results of every scan
constexpr std::chrono::milliseconds kStopCheck(20);
constexpr int kMaxRefusing = 32;  // refused connections that are told why at once; more are just closed
constexpr std::int64_t kRefusedRetry_ms = 5000;
constexpr std::chrono::milliseconds kGoodbyePatience(500);  // for last messages to leave

ListenAddress checked_address(const ServiceOptions& options) {
  Result<ListenAddress> address = parse_listen_address(options.listen);
  if (!address.ok()) throw SetupError(address.error());
  if (!is_loopback(*address) && !options.insecure_listen)
    throw SetupError({ErrorCode::kInvalidArgument,
                      "--listen " + options.listen +
                          " is reachable from other machines and the connection is not encrypted: listen on 127.0.0.1 behind "
                          "a TLS proxy, or add --insecure-i-know"});
  return *address;
}

void check_range(const char* name, int value, int low, int high) {
  if (value < low || value > high)
    throw SetupError({ErrorCode::kInvalidArgument, std::string(name) + " is " + std::to_string(value) + ", allowed is " +
                                                       std::to_string(low) + " to " + std::to_string(high)});
}

Limits checked_limits(const Limits& limits) {
  check_range("--max-connections", limits.connections, 1, 10'000);
  check_range("--connections-per-address", limits.connections_per_address, 1, 10'000);
  check_range("--requests-per-second", limits.requests_per_second, 1, 10'000);
  check_range("--failures-per-minute", limits.failures_per_minute, 1, 1000);
  check_range("--scans-per-token", limits.scans_per_token, 1, 64);
  check_range("--storage-gb", limits.storage_gb, 0, 1'000'000);
  return limits;
}

ScansOptions scans_options(const ServiceOptions& options) {
  check_range("--max-scans", options.max_scans, 1, 64);
  check_range("--credit-window", options.credit_window, 1, 256);
  return {options.device,
          options.max_scans,
          static_cast<std::uint32_t>(options.credit_window),
          options.gpu_memory_mb,
          options.limits.scans_per_token,
          static_cast<std::uint64_t>(options.limits.storage_gb) * 1'000'000'000};
}

AllowedHosts allowed_hosts(const ServiceOptions& options) {
  AllowedHosts hosts = default_hosts();
  hosts.insert(hosts.end(), options.allow_hosts.begin(), options.allow_hosts.end());
  return hosts;
}

// The service works without its viewer: cameras do not need it.
StaticFiles viewer_files(const std::string& folder) {
  Result<StaticFiles> files = read_static_files(folder);
  if (files.ok()) return *std::move(files);
  spdlog::warn("no web viewer: {}", files.error().message);
  return {};
}

tcp::acceptor open_port(asio::io_context& context, const ListenAddress& address) {
  error_code error;
  const tcp::endpoint endpoint(asio::ip::make_address(address.host, error), address.port);
  tcp::acceptor acceptor(context);
  if (!error) acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) throw SetupError({ErrorCode::kIo, "listening on " + url_of(address) + ": " + error.message()});
  return acceptor;
}

}  // namespace

// Declared in the order in which things depend on each other; the context, with all its connections, goes first of all.
struct Service::Impl {
  const ServiceOptions options;
  ListenAddress address;
  const AllowedHosts hosts;
  const DataDirectory data;
  const StaticFiles files;
  Store store;
  std::unique_ptr<Scans> scans;
  std::unique_ptr<HttpWorld> world;
  std::string url;
  Gate gate;
  CountLimit connections;
  RateLimit requests;
  int refusing_count = 0;
  bool token_works = false;
  bool stopping = false;
  bool ended_in_time = true;
  asio::io_context context{1};
  std::optional<tcp::acceptor> acceptor;
  asio::signal_set signals{context};

  explicit Impl(const ServiceOptions& service_options)
      : options(service_options),
        address(checked_address(service_options)),
        hosts(allowed_hosts(service_options)),
        data(service_options.data_folder),
        files(viewer_files(service_options.web_folder)),
        store(data.database_path()),
        gate(store, checked_limits(options.limits).failures_per_minute),
        connections(options.limits.connections, options.limits.connections_per_address),
        requests(options.limits.requests_per_second, 2.0 * options.limits.requests_per_second) {
    token_works = gate.install_first_token(data.token(), unix_now_ms());
    scans = std::make_unique<Scans>(scans_options(options), data, store,
                                    [this](std::function<void()> action) { asio::post(context, std::move(action)); });
    world = std::make_unique<HttpWorld>(HttpWorld{*scans, store, gate, files});
    acceptor = open_port(context, address);
    address.port = acceptor->local_endpoint().port();
    url = url_of(address);
    if (const Status published = data.publish_address(url); !published.ok()) throw SetupError(published.error());
  }

  asio::awaitable<void> serve(tcp::socket socket, std::string from) {
    // However it ends: a place that is never given back would in the end lock everybody out.
    struct Place {
      CountLimit& connections;
      const std::string& from;
      ~Place() { connections.leave(from); }
    } const place{connections, from};
    co_await serve_connection(std::move(socket), from, *world, {hosts, requests});
  }

  asio::awaitable<void> refuse(tcp::socket socket) {
    ++refusing_count;
    co_await refuse_connection(std::move(socket), wait_answer(503, "too many connections are open", kRefusedRetry_ms));
    --refusing_count;
  }

  void take(tcp::socket socket) {
    error_code error;
    const tcp::endpoint other_end = socket.remote_endpoint(error);
    if (error) return;  // it is gone already
    const std::string from = address_group(other_end.address().to_string());
    if (connections.enter(from)) {
      asio::co_spawn(context, serve(std::move(socket), from), asio::detached);
    } else if (refusing_count < kMaxRefusing) {
      spdlog::warn("refused a connection from {}: {} are open", from, connections.count());
      asio::co_spawn(context, refuse(std::move(socket)), asio::detached);
    }
  }

  asio::awaitable<void> accept() {
    while (!stopping) {
      error_code error;
      tcp::socket socket = co_await acceptor->async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (error == asio::error::operation_aborted) co_return;
      if (error) {
        // Out of file descriptors, most likely: others have to leave first.
        spdlog::warn("accepting a connection: {}", error.message());
        asio::steady_timer pause(context, std::chrono::milliseconds(100));
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      } else {
        take(std::move(socket));
      }
    }
  }

  asio::awaitable<void> end() {
    stopping = true;
    error_code error;
    acceptor->close(error);
    signals.cancel(error);
    scans->stop();
    asio::steady_timer pause(context);
    const auto deadline = std::chrono::steady_clock::now() + kStopPatience;
    while (scans->running_count() > 0 && std::chrono::steady_clock::now() < deadline) {
      pause.expires_after(kStopCheck);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
    ended_in_time = scans->running_count() == 0;
    if (connections.count() > 0) {
      pause.expires_after(kGoodbyePatience);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
    context.stop();
  }

  void begin_end() {
    if (stopping) return;
    stopping = true;
    asio::co_spawn(context, end(), asio::detached);
  }
};

Service::Service(const ServiceOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Service::~Service() = default;

const std::string& Service::url() const { return impl_->url; }
const std::string& Service::token() const { return impl_->data.token(); }
bool Service::token_works() const { return impl_->token_works; }

bool Service::run() {
  Impl& service = *impl_;
  if (service.options.stop_on_signals) {
    service.signals.add(SIGINT);
    service.signals.add(SIGTERM);
    service.signals.async_wait([&service](const error_code& error, int signal) {
      if (error) return;
      spdlog::info("signal {}: stopping", signal);
      service.begin_end();
    });
  }
  asio::co_spawn(service.context, service.accept(), asio::detached);
  service.context.run();
  if (!service.ended_in_time) spdlog::error("a scan did not end within {} s", kStopPatience.count());
  return service.ended_in_time;
}

void Service::stop() {
  asio::post(impl_->context, [service = impl_.get()] { service->begin_end(); });
}

}  // namespace hermite
