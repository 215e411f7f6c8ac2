// A real S3 server, OpenStack Swift (tests/support/s3/swift_server.py), and a proxy in front of it
// that does what a bad network or a bad server does. Both live as long as their objects.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "server/s3/s3_options.h"
#include "tests/source_root/source_root.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

class SwiftServer {
 public:
  SwiftServer() { start(); }
  ~SwiftServer() { kill(); }
  SwiftServer(const SwiftServer&) = delete;
  SwiftServer& operator=(const SwiftServer&) = delete;

  // The one of this program; nullptr: python3-swift is not installed.
  static SwiftServer* shared() {
    static SwiftServer server;
    return server.port_ > 0 ? &server : nullptr;
  }

  static std::string missing() {
    return shared() ? "" : "python3-swift (deploy/packages.txt) is not installed";
  }

  int port() const { return port_; }

  void kill() {
    if (pid_ <= 0) return;
    close(keep_alive_);
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

  // Where it was, with what it has stored. It takes a second.
  void start() {
    int to[2], from[2];
    if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) return;
    const std::string script = (source_root() / "tests/support/s3/swift_server.py").string(),
                      port = std::to_string(port_), folder = folder_.path();
    pid_ = fork();
    if (pid_ == 0) {
      dup2(to[0], STDIN_FILENO);
      dup2(from[1], STDOUT_FILENO);
      execl("/usr/bin/python3", "python3", script.c_str(), folder.c_str(), "--port", port.c_str(),
            nullptr);
      _exit(77);
    }
    close(to[0]);
    close(from[1]);
    keep_alive_ = to[1];
    std::array<char, 32> text{};
    const ssize_t count = ::read(from[0], text.data(), text.size() - 1);  // a whole line
    close(from[0]);
    port_ = count > 0 ? std::atoi(text.data()) : 0;
  }

 private:
  const TemporaryFolder folder_;
  pid_t pid_ = -1;
  int keep_alive_ = -1;
  int port_ = 0;
};

// Of the bucket of the server on this port, under a new prefix each time.
inline server::S3Options s3_options_at(int port) {
  static std::atomic<int> count = 0;
  server::S3Options options;
  options.endpoint = "http://127.0.0.1:" + std::to_string(port);
  options.bucket = "scans";
  options.prefix = "prefix-" + std::to_string(++count) + "/";
  options.credentials = {"hermite:tests", "testing", ""};
  options.patience.first_pause = std::chrono::milliseconds(10);
  options.patience.short_breath = std::chrono::milliseconds(0);
  return options;
}

namespace http = boost::beast::http;

// What the proxy does with one exchange.
struct Exchange {
  http::request<http::string_body> request;
  http::response<http::string_body> response;  // of the real server, to be altered
  // Bytes of the answer, after which the connection is closed.
  std::optional<std::size_t> cut_after;
  std::chrono::milliseconds pause{0};  // before the answer
};

// Passes requests to the server on a port, and alters the answers with `alter`, which is called on
// several threads.
class S3Proxy {
 public:
  using Alter = std::function<void(Exchange&)>;
  S3Proxy(int port, Alter alter)
      : to_(boost::asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)),
        alter_(std::move(alter)) {
    thread_ = std::thread([this] { accept(); });
  }
  ~S3Proxy() {
    stopped_ = true;
    boost::system::error_code ignored;
    // Wakes accept().
    boost::asio::ip::tcp::socket(context_).connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
    {
      const std::lock_guard lock(mutex_);
      for (auto& client : clients_)
        client->shutdown(boost::asio::socket_base::shutdown_both, ignored);
    }
    for (std::thread& one : connections_) one.join();
  }
  int port() const { return acceptor_.local_endpoint().port(); }
  int request_count() const { return request_count_; }

 private:
  using tcp = boost::asio::ip::tcp;

  void accept() {
    for (;;) {
      auto client = std::make_shared<tcp::socket>(context_);
      boost::system::error_code error;
      acceptor_.accept(*client, error);
      if (stopped_) return;
      if (error) continue;
      const std::lock_guard lock(mutex_);
      clients_.push_back(client);
      connections_.emplace_back([this, client] { serve(*client); });
    }
  }

  bool pass_on(Exchange& exchange) {
    boost::system::error_code error;
    tcp::socket server(context_);
    server.connect(to_, error);
    exchange.request.set("Connection", "close");
    if (!error) http::write(server, exchange.request, error);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::uint64_t{1} << 30);
    parser.skip(exchange.request.method() == http::verb::head);
    if (!error) http::read(server, buffer, parser, error);
    exchange.response = parser.release();
    exchange.response.erase("Connection");
    if (exchange.response.erase("Transfer-Encoding") > 0)
      exchange.response.content_length(exchange.response.body().size());
    return !error;
  }

  void serve(tcp::socket& client) {
    boost::system::error_code error;
    boost::beast::flat_buffer buffer;
    while (!error && !stopped_) {
      http::request_parser<http::string_body> parser;
      parser.body_limit(std::uint64_t{1} << 30);
      http::read(client, buffer, parser, error);
      if (error) break;
      ++request_count_;
      Exchange exchange;
      exchange.request = parser.release();
      exchange.request.erase("Expect");
      if (!pass_on(exchange)) break;
      alter_(exchange);
      for (auto waited = std::chrono::milliseconds(0); waited < exchange.pause && !stopped_;
           waited += std::chrono::milliseconds(10))
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      std::ostringstream text;
      // With the announced length as it was, unless `alter` has changed it.
      text << exchange.response.base();
      std::string bytes = text.str();
      if (exchange.request.method() != http::verb::head) bytes += exchange.response.body();
      if (exchange.cut_after) bytes.resize(std::min(bytes.size(), *exchange.cut_after));
      boost::asio::write(client, boost::asio::buffer(bytes), error);
      if (exchange.cut_after) break;
    }
    const std::lock_guard lock(mutex_);
    boost::system::error_code ignored;
    client.shutdown(boost::asio::socket_base::shutdown_both, ignored);
    client.close(ignored);
  }

  boost::asio::io_context context_;
  const tcp::endpoint to_;
  const Alter alter_;
  tcp::acceptor acceptor_{context_, tcp::endpoint(boost::asio::ip::make_address("127.0.0.1"), 0)};
  std::atomic<bool> stopped_ = false;
  std::atomic<int> request_count_ = 0;
  std::mutex mutex_;  // guards what follows
  std::list<std::shared_ptr<tcp::socket>> clients_;
  std::list<std::thread> connections_;
  std::thread thread_;
};

}  // namespace hermite::test

// The test needs a real S3 server.
#define SKIP_WITHOUT_SWIFT()                                                             \
  if (const std::string reason = hermite::test::SwiftServer::missing(); !reason.empty()) \
  GTEST_SKIP() << reason
