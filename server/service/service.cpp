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
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <optional>

#include "core/dataset/recording.h"
#include "server/access/access.h"
#include "server/access/audit.h"
#include "server/access/gate.h"
#include "server/access/rate_limit.h"
#include "server/connections/http_connection.h"
#include "server/disk/orphans.h"
#include "server/disk/retention_clock.h"
#include "server/disk/storage.h"
#include "server/disk/store_watch.h"
#include "server/exports/exports.h"
#include "server/net/service_manager.h"
#include "server/net/tls.h"
#include "server/routes/admin.h"
#include "server/routes/static_files.h"
#include "server/scan/scans.h"
#include "server/service/batch_setup.h"
#include "server/service/connection_acceptor.h"
#include "server/service/limits.h"
#include "server/service/results_place.h"
#include "server/service/service_setup.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

// For monitoring; counted separately from cameras and viewers, so that a server without free
// connections can still be monitored.
constexpr int kMaxAdminConnections = 32;
constexpr const char* kVersion = HERMITE_VERSION;
// Time for the current frame and the results of every scan.
constexpr std::chrono::seconds kStopPatience(60);
constexpr std::chrono::milliseconds kStopCheck(20);
constexpr std::chrono::milliseconds kTick(250);             // accuracy of timeouts given in seconds
constexpr std::chrono::milliseconds kGoodbyePatience(500);  // for last messages to be sent
// How much of the audit log a power failure can destroy.
constexpr std::chrono::seconds kAuditPeriod(1);
// Uploads and results wait for disks, not for processors.
constexpr std::size_t kDiskThreads = 2;
constexpr std::size_t kRemoteThreads = 8;  // of these, some wait for a network
// While logs are read, results are read for viewers, old logs removed and file sizes added up.
constexpr std::size_t kBackgroundThreads = kMaxLogsRead + 2;

}  // namespace

// Members are declared in order of dependency. So the thread pools are destroyed first, then the
// context with all its connections.
struct Service::Impl {
  const ServiceOptions options;
  ListenAddress address;
  std::optional<ListenAddress> admin_address;
  TlsContext tls;  // for new connections; nullptr: not encrypted
  const DataDirectory data;
  const StaticFiles files;
  Store store;
  ResultsPlace results;
  Blobs& blobs = results.blobs();
  StoreWatch store_watch{store};
  Metrics metrics{kVersion};
  Gate gate;
  std::unique_ptr<Audit> audit;
  std::unique_ptr<RetentionClock> retention;
  CountLimit connections, admin_connections{kMaxAdminConnections, kMaxAdminConnections};
  RateLimit requests, requests_of_a_token;
  ShareCount sessions;
  MeasuringCache measuring;
  std::unique_ptr<Waste> waste;
  std::unique_ptr<StorageQuota> quota;
  std::unique_ptr<Scans> scans;
  std::unique_ptr<SlurmCluster> slurm;  // nullptr: jobs are done here
  std::unique_ptr<Batch> batch;
  std::unique_ptr<Exports> exports;
  std::unique_ptr<HttpWorld> world;
  std::unique_ptr<DeviceWatch> device;
  std::unique_ptr<AdminWorld> admin_world;
  std::unique_ptr<Site> site, admin_site;
  std::string url;
  const ServiceManager manager;
  ConnectionAcceptor connection_acceptor{tls};
  bool token_works = false;
  bool draining = false;  // no new connections and scans; running ones may continue
  bool ending = false;    // running scans are interrupted
  bool ended_in_time = true;
  asio::io_context context{1};
  std::optional<tcp::acceptor> acceptor, admin_acceptor;
  asio::signal_set signals{context};
  asio::steady_timer watchdog{context}, drained{context};
  asio::thread_pool background{kBackgroundThreads};
  // For exports, so that nothing else waits for them.
  asio::thread_pool making{1};
  // Last member: its work refers to connections.
  asio::thread_pool disk{results.is_remote() ? kRemoteThreads : kDiskThreads};

  explicit Impl(const ServiceOptions& service_options)
      : options(checked(service_options)),
        address(checked_address(service_options)),
        admin_address(checked_admin_address(service_options)),
        tls(tls_of(service_options)),
        data(service_options.data_folder),
        files(viewer_files(service_options.web_folder)),
        store(opened_rows(service_options)),
        results(options, data),
        gate(store, options.failures_per_minute),
        connections(options.max_connections, options.connections_per_address),
        requests(options.requests_per_second, 2.0 * options.requests_per_second),
        requests_of_a_token(options.requests_per_second, 2.0 * options.requests_per_second),
        sessions(connection_share(options)) {
    open_audit();
    retention = std::make_unique<RetentionClock>(data.retention_path(), unix_now_ms(),
                                                 std::chrono::steady_clock::now());
    token_works = gate.install_first_token(data.token(), retention->now_ms());
    const auto post = [this](std::function<void()> action) {
      asio::post(context, std::move(action));
    };
    const LogReaders::Threads threads{
        post, [this](std::function<void()> action) { asio::post(background, std::move(action)); }};
    clear_orphans(data, store, retention->now_ms());
    waste = std::make_unique<Waste>(data.set_aside(), threads.background);
    quota = std::make_unique<StorageQuota>(
        static_cast<std::uint64_t>(options.storage_gb) * 1'000'000'000,
        [this] { return results.scan_sizes(); }, threads);
    const Storage storage{data, store, blobs, *waste, *quota};
    if (const Status recovered = recover_batch(storage, jobs_elsewhere(options)); !recovered.ok())
      throw SetupError(recovered.error());
    scans = std::make_unique<Scans>(scans_options(options), storage, metrics, threads);
    slurm = slurm_of(options, store);
    batch = std::make_unique<Batch>(batch_options(options, upload_limits(options), slurm.get()),
                                    storage, *scans, post);
    exports = std::make_unique<Exports>(blobs, export_hooks(threads.network));
    if (!options.mesh_on_demand)
      scans->when_finished([this](const ScanRow& scan) { exports->make_mesh(scan); });
    world = std::make_unique<HttpWorld>(HttpWorld{
        *scans, store, gate, files, metrics, batch->uploads(), batch->executor(), sessions,
        requests_of_a_token, *audit, *exports, measuring, frame_ancestors_of(options)});
    open_site();
    if (admin_address) open_admin();
    // Before anybody is told that the server is there: whoever stops it then has it end as later
    // on.
    if (options.stop_on_signals)
      for (const int signal : {SIGINT, SIGTERM, SIGHUP}) signals.add(signal);
  }

  // Its thread posts to the context, which goes before it.
  ~Impl() {
    if (slurm) slurm->stop();
  }

  void open_audit() {
    audit = std::make_unique<Audit>(data.audit_folder(), unix_now_ms());
    if (!audit->missing().empty())
      spdlog::error("the audit log was changed while no server ran: {}", audit->missing());
    spdlog::info("the audit log goes on behind entry {}, {}", audit->entry_count(),
                 audit->head().substr(0, 16));
    audit->note({unix_now_ms(), "", "", "server start", "", kVersion});
    gate.on_wrong_secret([this](const Caller& caller) {
      audit->wrong_token(caller.peer.empty() ? caller.address : caller.peer);
    });
  }

  Exports::Hooks export_hooks(const LogReaders::Post& network) {
    return {network,
            [this](std::function<void()> action) { asio::post(making, std::move(action)); },
            [this](const std::string& scan_id) { return scans->rows().find(scan_id); },
            [this](const std::string& scan_id) -> Result<std::unique_ptr<dataset::Sequence>> {
              Result<dataset::Recording> log =
                  dataset::open_frame_log(data.log_folder(scan_id), std::nullopt);
              return log.ok() ? Result<std::unique_ptr<dataset::Sequence>>(std::move(log->sequence))
                              : log.error();
            },
            [this](std::uint64_t bytes) { return scans->room().check_disk_for(bytes); },
            [this] { quota->files_changed(); },
            [this](const std::string& scan_id) {
              if (const Status removed =
                      remove_files_of_scan({data, store, blobs, *waste, *quota}, scan_id);
                  !removed.ok())
                spdlog::warn("scan {}: {}", scan_id, removed.error().message);
            }};
  }

  void open_site() {
    site = std::make_unique<Site>(
        Site{[this](const HttpRequest& request) { return answer(*world, request); },
             allowed_hosts(options, address), metrics, world.get(), proxies_of(options),
             !is_loopback(address) && !tls && !options.insecure_listen, &requests, &disk});
    acceptor = open_port(context, address);
    address.port = acceptor->local_endpoint().port();
    url = url_of(address);
    if (tls) url.replace(0, 4, "https");
    if (const Status published = data.lock().publish_address(url); !published.ok())
      throw SetupError(published.error());
  }

  void open_admin() {
    try {
      admin_acceptor = open_port(context, *admin_address);
    } catch (const SetupError& error) {
      // Several servers on one machine should not need an address that nobody asked for.
      if (options.admin_listen != ServiceOptions().admin_listen) throw;
      spdlog::warn("no health and metrics: {}; choose another --admin-listen, or off",
                   error.what());
      return;
    }
    admin_address->port = admin_acceptor->local_endpoint().port();
    device = std::make_unique<DeviceWatch>(options.device);
    admin_world = std::make_unique<AdminWorld>(AdminWorld{
        *scans, store, metrics, *device, store_watch, options.data_folder,
        static_cast<std::uint64_t>(options.min_free_disk_mb) * 1'000'000, connections, draining});
    admin_site = std::make_unique<Site>(
        Site{[this](const HttpRequest& request) { return answer_admin(*admin_world, request); },
             allowed_hosts(options, *admin_address), metrics});
  }

  asio::awaitable<void> tick() {
    asio::steady_timer pause(context);
    std::chrono::steady_clock::time_point audited_at;
    while (!ending) {
      error_code error;
      pause.expires_after(kTick);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      const auto now = std::chrono::steady_clock::now();
      retention->tick(unix_now_ms(), now);
      scans->tick(now, retention->now_ms());
      batch->tick(now, retention->now_ms());
      exports->tick(now);
      if (now - audited_at >= kAuditPeriod) {
        audited_at = now;
        audit->tick(unix_now_ms());
      }
      store_watch.tick(now);
    }
  }

  // Stops accepting new connections and scans, and waits until running scans have ended or their
  // time is over.
  asio::awaitable<void> drain() {
    manager.tell("STOPPING=1");
    error_code error;
    acceptor->close(error);
    scans->refuse_new();
    batch->refuse_new();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(options.drain_s);
    if (scans->running_count() > 0 && !ending)
      spdlog::info("{} scan(s) may go on for {} s; another signal ends them at once",
                   scans->running_count(), options.drain_s);
    while (scans->running_count() > 0 && !ending && std::chrono::steady_clock::now() < deadline) {
      drained.expires_after(kStopCheck);
      co_await drained.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
    co_await end();
  }

  asio::awaitable<void> end() {
    ending = true;
    error_code error;
    batch->stop();
    scans->stop();
    exports->stop();
    asio::steady_timer pause(context);
    const auto deadline = std::chrono::steady_clock::now() + kStopPatience;
    const auto busy = [this] {
      return scans->running_count() + batch->running_count() + exports->running_count() > 0;
    };
    while (busy() && std::chrono::steady_clock::now() < deadline) {
      pause.expires_after(kStopCheck);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
    ended_in_time = !busy();
    if (connections.count() > 0) {
      pause.expires_after(kGoodbyePatience);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
    signals.cancel(error);
    context.stop();
  }

  // Lets running scans continue for a while or, with `at_once`, interrupts them.
  void begin_end(bool at_once) {
    ending = ending || at_once;
    if (draining) return;
    draining = true;
    asio::co_spawn(context, drain(), asio::detached);
  }

  void read_certificate_again() {
    if (!tls) return;
    Result<TlsContext> again = server_tls(options.tls_certificate, options.tls_key);
    if (again.ok()) {
      tls = *std::move(again);
      spdlog::info("new connections get the certificate {} as it is now", options.tls_certificate);
    } else {
      spdlog::error("the old certificate stays: {}", again.error().message);
    }
  }

  void await_signal() {
    signals.async_wait([this](const error_code& error, int signal) {
      if (error) return;
      if (signal == SIGHUP) {
        read_certificate_again();
      } else {
        spdlog::info("signal {}: stopping", signal);
        // A user at a terminal, or a second signal, means not to wait.
        begin_end(signal == SIGINT || draining);
      }
      await_signal();
    });
  }

  // Called in the event loop, so that a hanging loop is noticed.
  void feed_watchdog() {
    const std::optional<std::chrono::microseconds> period = manager.watchdog_period();
    if (!period) return;
    manager.tell("WATCHDOG=1");
    watchdog.expires_after(*period);
    watchdog.async_wait([this](const error_code& error) {
      if (!error) feed_watchdog();
    });
  }
};

// What a database or a disk says of its failure does not name a place by itself.
Service::Service(const ServiceOptions& options) try : impl_(std::make_unique<Impl>(options)) {
} catch (const SetupError& failure) {
  if (failure.error().code != ErrorCode::kIo) throw;
  throw SetupError(in_context("starting with the data in " + options.data_folder, failure.error()));
}
Service::~Service() = default;

const std::string& Service::url() const { return impl_->url; }
const std::string& Service::token() const { return impl_->data.token(); }
bool Service::token_works() const { return impl_->token_works; }
int Service::admin_port() const { return impl_->admin_acceptor ? impl_->admin_address->port : 0; }

bool Service::run() {
  Impl& service = *impl_;
  if (service.options.stop_on_signals) service.await_signal();
  asio::co_spawn(service.context,
                 service.connection_acceptor.accept(*service.acceptor,
                                                    {*service.site, service.connections, true}),
                 asio::detached);
  asio::co_spawn(service.context, service.tick(), asio::detached);
  if (service.admin_acceptor)
    asio::co_spawn(
        service.context,
        service.connection_acceptor.accept(*service.admin_acceptor,
                                           {*service.admin_site, service.admin_connections, false}),
        asio::detached);
  service.feed_watchdog();
  service.manager.tell("READY=1\nSTATUS=serving " + service.url);
  service.context.run();
  if (!service.ended_in_time)
    spdlog::error("a scan did not end within {} s", kStopPatience.count());
  return service.ended_in_time;
}

void Service::stop() {
  asio::post(impl_->context, [service = impl_.get()] { service->begin_end(true); });
}

}  // namespace hermite::server
