#include "server/client/load_viewers.h"

#include <fmt/core.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"
#include "server/client/backoff.h"
#include "server/client/client_socket.h"
#include "server/client/load_machine.h"

namespace hermite::client {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using SteadyTime = std::chrono::steady_clock::time_point;

constexpr int kViewersOfAThread = 250;
// Time between looking for a scan while none runs: ten thousand viewers shall not keep the machine
// busy with that.
constexpr std::chrono::milliseconds kLookPeriod(500);
constexpr std::chrono::milliseconds kViewersClosePatience(2000);
// All that a viewer sends is short, and a buffer of the usual size for each of thousands would take
// most of the memory.
constexpr std::size_t kViewerWriteBuffer_bytes = 1024;
constexpr std::size_t kKeptReadBuffer_bytes = 16 * 1024;

// What the viewers of one thread share. Everything but `scans` and `watching` belongs to that
// thread.
struct ViewerGround {
  const LoadViewersPlan& plan;
  LoadScans& scans;
  std::atomic<int>& watching;
  ViewerLoad load;
  bool stopping = false;
};

// One viewer, on the thread of its group.
class LoadViewer {
 public:
  LoadViewer(ViewerGround& ground, asio::io_context& io) : ground_(ground), pause_(io) {}

  asio::awaitable<void> live(SteadyTime begin);
  void stop();   // closes the connection
  void abort();  // without waiting for the server

 private:
  // However watch() ends, even by an exception.
  struct Forget {
    LoadViewer& viewer;
    ~Forget() {
      viewer.socket_ = nullptr;
      viewer.connected_ = false;
      viewer.leave();
    }
  };

  asio::awaitable<void> sleep_until(SteadyTime time);
  asio::awaitable<bool> watch(std::string scan_id);
  asio::awaitable<beast::error_code> receive_all(ClientSocket& socket);
  void handle(std::string_view bytes);
  bool count_end(const std::string& reason);
  void leave();

  ViewerGround& ground_;
  asio::steady_timer pause_;
  ClientSocket* socket_ = nullptr;  // while there is one
  bool connected_ = false;          // as a WebSocket

  // Of the present connection.
  SteadyTime connecting_since_;
  std::optional<SteadyTime> welcomed_at_;
  bool snapshot_ended_ = false, scan_ended_ = false;
  std::string error_;  // the server's
  std::uint64_t received_bytes_ = 0;
};

asio::awaitable<void> LoadViewer::sleep_until(SteadyTime time) {
  beast::error_code ignored;
  pause_.expires_at(time);
  co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
}

asio::awaitable<void> LoadViewer::live(SteadyTime begin) {
  co_await sleep_until(begin);
  Backoff backoff(std::random_device{}());
  while (!ground_.stopping) {
    const std::optional<std::string> scan_id = ground_.scans.take();
    if (!scan_id) {
      co_await sleep_until(std::chrono::steady_clock::now() + kLookPeriod);
      continue;
    }
    const bool well = co_await watch(*scan_id);
    ground_.scans.give_back(*scan_id);
    if (well) backoff = Backoff(std::random_device{}());
    // Also after a scan that has ended: it may still be given to viewers for a moment.
    const auto pause = well ? kLookPeriod : std::max(backoff.next(), kLookPeriod);
    if (!ground_.stopping) co_await sleep_until(std::chrono::steady_clock::now() + pause);
  }
}

// Returns whether the viewer was served until the scan ended.
asio::awaitable<bool> LoadViewer::watch(std::string scan_id) {
  connecting_since_ = std::chrono::steady_clock::now();
  welcomed_at_.reset();
  snapshot_ended_ = scan_ended_ = false;
  error_.clear();
  received_bytes_ = 0;
  ClientSocket socket(
      server::Transport(beast::tcp_stream(pause_.get_executor()), ground_.plan.tls));
  socket_ = &socket;
  const Forget forget{*this};
  prepare_socket(socket, ground_.plan.patience);
  socket.write_buffer_bytes(kViewerWriteBuffer_bytes);
  beast::get_lowest_layer(socket).expires_after(ground_.plan.patience);
  std::optional<Error> failure;
  co_await connect_socket(socket, ground_.plan.server, failure);
  std::string reason;
  if (failure) {
    reason = failure->message;
  } else if (!ground_.stopping) {
    connected_ = true;
    wire::Hello hello{wire::kProtocolMinor, "hermite-client load", ground_.plan.server.token,
                      wire::ViewScan{std::move(scan_id)}};
    const std::string bytes = wire::format_client_message(std::move(hello));
    beast::error_code error;
    co_await socket.async_write(asio::buffer(bytes),
                                asio::redirect_error(asio::use_awaitable, error));
    ground_.load.sent_bytes += bytes.size();
    // Even if that failed: the server may have said why it closes.
    error = co_await receive_all(socket);
    if (error == boost::beast::websocket::error::closed &&
        socket.reason().code == boost::beast::websocket::close_code::normal)
      scan_ended_ = true;
    reason = "the connection ended: " + why_ended(socket, error);
  }
  co_return count_end(error_.empty() ? reason : error_);
}

// Receives until the connection ends; returns why. Acknowledges every message, as a browser does
// that is done with one before the next comes.
asio::awaitable<beast::error_code> LoadViewer::receive_all(ClientSocket& socket) {
  beast::flat_buffer incoming;
  beast::error_code error;
  for (;;) {
    co_await socket.async_read(incoming, asio::redirect_error(asio::use_awaitable, error));
    if (error) co_return error;
    const auto data = incoming.data();
    if (!ground_.stopping) handle({static_cast<const char*>(data.data()), data.size()});
    incoming.clear();
    if (incoming.capacity() > kKeptReadBuffer_bytes) incoming.shrink_to_fit();
    if (ground_.stopping) continue;  // the connection is being closed
    const std::string ack = wire::format_client_message(wire::ViewerAck{received_bytes_});
    beast::error_code not_written;  // reading says why
    co_await socket.async_write(asio::buffer(ack),
                                asio::redirect_error(asio::use_awaitable, not_written));
    if (!not_written) ground_.load.sent_bytes += ack.size();
  }
}

void LoadViewer::handle(std::string_view bytes) {
  received_bytes_ += bytes.size();
  ground_.load.received_bytes += bytes.size();
  ++ground_.load.messages;
  const auto message = wire::parse_server_message(bytes);
  if (!message.ok()) {
    count_message(ground_.load.problems, "a message of the server: " + message.error().message);
    return;
  }
  const SteadyTime now = std::chrono::steady_clock::now();
  if (std::holds_alternative<wire::Welcome>(*message) && !welcomed_at_) {
    welcomed_at_ = now;
    ++ground_.load.watched;
    ++ground_.watching;
  } else if (std::holds_alternative<wire::SnapshotEnd>(*message) && !snapshot_ended_) {
    snapshot_ended_ = true;
    ground_.load.snapshot_ms.push_back(
        std::chrono::duration<float, std::milli>(now - connecting_since_).count());
  } else if (const auto* state = std::get_if<wire::ScanState>(&*message)) {
    scan_ended_ = state->phase != wire::ScanPhase::kRunning;
  } else if (const auto* said = std::get_if<wire::ErrorMessage>(&*message)) {
    error_ = fmt::format("the server says: {} ({})", said->message, said->code);
  }
}

// Ends the time that it was served.
void LoadViewer::leave() {
  if (!welcomed_at_) return;
  --ground_.watching;
  ground_.load.watched_s +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - *welcomed_at_).count();
  welcomed_at_.reset();
}

// Returns whether the connection ended because the scan has, or because the test is over.
bool LoadViewer::count_end(const std::string& reason) {
  if (ground_.stopping || (welcomed_at_ && scan_ended_)) return true;
  ++(welcomed_at_ ? ground_.load.disconnected : ground_.load.refused);
  count_message(ground_.load.problems, reason);
  return false;
}

void LoadViewer::stop() {
  leave();
  pause_.cancel();
  if (!socket_) return;
  if (connected_)
    socket_->async_close(boost::beast::websocket::close_code::normal,
                         [](const beast::error_code&) {});
  else
    abort();
}

void LoadViewer::abort() {
  if (socket_) beast::get_lowest_layer(*socket_).close();
}

}  // namespace

// The viewers of one thread.
class LoadViewers::Group {
 public:
  // The viewers first, first + step, first + 2 step, ... of the plan.
  Group(const LoadViewersPlan& plan, LoadScans& scans, std::atomic<int>& watching, int first,
        int step)
      : plan_(plan), ground_{plan_, scans, watching, {}, false} {
    for (int i = first; i < plan_.count; i += step) {
      LoadViewer& viewer = viewers_.emplace_back(ground_, io_);
      const auto delay =
          std::chrono::duration_cast<SteadyTime::duration>(plan_.ramp * i / plan_.count);
      ++living_;
      asio::co_spawn(io_, viewer.live(began_ + delay),
                     [this](std::exception_ptr failure) { died(failure != nullptr); });
    }
    thread_ = std::thread([this] { run(); });
  }
  ~Group() {
    if (thread_.joinable()) stop();
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  void begin_stopping() {
    asio::post(io_, [this] {
      ground_.stopping = true;
      for (LoadViewer& viewer : viewers_) viewer.stop();
      if (living_ == 0) return;
      closing_.expires_after(kViewersClosePatience);
      closing_.async_wait([this](const beast::error_code&) {
        for (LoadViewer& viewer : viewers_) viewer.abort();
      });
    });
  }

  // After begin_stopping(). Returns what was measured.
  const ViewerLoad& join() {
    thread_.join();
    return ground_.load;
  }

 private:
  void stop() {
    begin_stopping();
    join();
  }

  void run() {
    io_.run();
    const double elapsed_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    ground_.load.busiest_thread = thread_cpu_s() / std::max(elapsed_s, 1e-3);
  }

  void died(bool by_exception) {
    if (by_exception && !ground_.stopping) {
      ++ground_.load.disconnected;
      count_message(ground_.load.problems,
                    "the load test could not go on with a viewer (out of memory or open files)");
    }
    if (--living_ == 0) closing_.cancel();
  }

  const SteadyTime began_ = std::chrono::steady_clock::now();
  const LoadViewersPlan plan_;
  ViewerGround ground_;
  asio::io_context io_{1};
  asio::steady_timer closing_{io_};
  std::deque<LoadViewer> viewers_;
  int living_ = 0;
  std::thread thread_;
};

int load_viewer_threads(int viewers, int cores) {
  return std::clamp((viewers + kViewersOfAThread - 1) / kViewersOfAThread, 1, std::max(cores, 1));
}

LoadViewers::LoadViewers(const LoadViewersPlan& plan, LoadScans& scans,
                         std::atomic<int>& watching) {
  const int threads = std::min(
      plan.count,
      load_viewer_threads(plan.count, static_cast<int>(std::thread::hardware_concurrency())));
  for (int i = 0; i < threads; ++i)
    groups_.push_back(std::make_unique<Group>(plan, scans, watching, i, threads));
}

LoadViewers::~LoadViewers() = default;

ViewerLoad LoadViewers::stop() {
  for (const auto& group : groups_) group->begin_stopping();
  std::vector<ViewerLoad> loads;
  for (const auto& group : groups_) loads.push_back(group->join());
  groups_.clear();
  return sum_of(loads);
}

}  // namespace hermite::client
