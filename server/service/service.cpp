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
#include "server/service/http_connection.h"
#include "server/service/scans.h"
#include "server/service/static_files.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace hermite {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kStopPatience(60);  // for the frame in work and the results of every scan
constexpr std::chrono::milliseconds kStopCheck(20);
constexpr std::chrono::milliseconds kTick(250);             // how exactly waits are ended that are given in seconds
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

ScansOptions scans_options(const ServiceOptions& options) {
  check_range("--max-scans", options.max_scans, 1, 64);
  check_range("--credit-window", options.credit_window, 1, 256);
  check_range("--keep-logs", options.keep_log_days, 0, 36500);
  check_range("--resume-window", options.resume_window_s, 0, 86400);
  return {options.device,
          options.max_scans,
          static_cast<std::uint32_t>(options.credit_window),
          options.gpu_memory_mb,
          std::chrono::seconds(options.resume_window_s),
          options.keep_log_days};
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
  int connection_count = 0;
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
        store(data.database_path()) {
    scans = std::make_unique<Scans>(scans_options(options), data, store,
                                    [this](std::function<void()> action) { asio::post(context, std::move(action)); });
    world = std::make_unique<HttpWorld>(HttpWorld{*scans, data.token(), files});
    acceptor = open_port(context, address);
    address.port = acceptor->local_endpoint().port();
    url = url_of(address);
  }

  asio::awaitable<void> serve(tcp::socket socket) {
    ++connection_count;
    co_await serve_connection(std::move(socket), *world, hosts);
    --connection_count;
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
      } else if (connection_count >= kMaxConnections) {
        spdlog::warn("refused a connection: {} are open, which is the limit", connection_count);
      } else {
        asio::co_spawn(context, serve(std::move(socket)), asio::detached);
      }
    }
  }

  asio::awaitable<void> tick() {
    asio::steady_timer pause(context);
    while (!stopping) {
      error_code error;
      pause.expires_after(kTick);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      scans->tick(std::chrono::steady_clock::now());
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
    if (connection_count > 0) {
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
  asio::co_spawn(service.context, service.tick(), asio::detached);
  service.context.run();
  if (!service.ended_in_time) spdlog::error("a scan did not end within {} s", kStopPatience.count());
  return service.ended_in_time;
}

void Service::stop() {
  asio::post(impl_->context, [service = impl_.get()] { service->begin_end(); });
}

}  // namespace hermite
