// A real PostgreSQL (postgres_server.py), and a proxy in front of it that loses connections. Both
// live as long as their objects.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/database/postgres_connection.h"
#include "tests/source_root/source_root.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

class PostgresServer {
 public:
  // The one of this program; nullptr: PostgreSQL is not installed.
  static PostgresServer* shared() {
    static PostgresServer server;
    return server.port_ > 0 ? &server : nullptr;
  }
  static std::string missing() {
    return shared() ? "" : "postgresql-15 (deploy/packages.txt) is not installed";
  }

  ~PostgresServer() {
    if (pid_ <= 0) return;
    close(to_);
    waitpid(pid_, nullptr, 0);
    close(from_);
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  int port() const { return port_; }
  void crash() {
    command("crash\n");
    is_crashed_ = true;
  }
  // Starts it again after a crash; nothing without one.
  void start() {
    if (std::exchange(is_crashed_, false)) command("start\n");
  }

  std::string url(const std::string& database, int port) const {
    return "postgresql://hermite@127.0.0.1:" + std::to_string(port) + "/" + database;
  }
  std::string url(const std::string& database) const { return url(database, port_); }

  // Returns the name of an empty database.
  std::string new_database() {
    static std::atomic<int> count = 0;
    const std::string name = "test" + std::to_string(++count);
    run("postgres", "CREATE DATABASE " + name);
    return name;
  }

  // Runs a statement on a connection of its own.
  server::SqlResult run(const std::string& database, const std::string& sql) const {
    return server::PostgresConnection(url(database), {}).run(sql);
  }

  // Ends all other connections to a database, as an administrator may.
  void disconnect(const std::string& database) const {
    run(database,
        "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE datname = "
        "current_database() AND pid <> pg_backend_pid()");
  }

 private:
  PostgresServer() {
    int to[2], from[2];
    if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) return;
    const std::string script =
                          (source_root() / "tests/support/postgres/postgres_server.py").string(),
                      folder = folder_.path();
    pid_ = fork();
    if (pid_ == 0) {
      dup2(to[0], STDIN_FILENO);
      dup2(from[1], STDOUT_FILENO);
      execl("/usr/bin/python3", "python3", script.c_str(), folder.c_str(), nullptr);
      _exit(77);
    }
    close(to[0]);
    close(from[1]);
    to_ = to[1];
    from_ = from[0];
    port_ = std::atoi(read_line().c_str());
  }

  std::string read_line() const {
    std::string line;
    for (char letter = 0; ::read(from_, &letter, 1) == 1 && letter != '\n';) line += letter;
    return line;
  }
  void command(std::string_view line) const {
    if (write(to_, line.data(), line.size()) == static_cast<ssize_t>(line.size())) read_line();
  }

  const TemporaryFolder folder_;
  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
  bool is_crashed_ = false;
  int port_ = 0;
};

// Forwards to a port. Before what the client sends goes on, `ask` says what happens to it.
class LossyProxy {
 public:
  enum class Fate {
    kForward,
    kLoseRequest,  // the connection ends, and the server has not got it
    kLoseAnswer,   // the server gets it, and the connection ends when the server has answered
  };

  LossyProxy(int port, std::function<Fate(std::string_view sent)> ask)
      : port_(port), ask_(std::move(ask)) {
    thread_ = std::thread([this] {
      boost::system::error_code error;
      for (;;) {
        tcp::socket client(context_);
        acceptor_.accept(client, error);
        if (error || ends_) return;
        const std::lock_guard lock(mutex_);
        connections_.emplace_back(std::move(client), *this);
      }
    });
  }
  ~LossyProxy() {
    ends_ = true;
    boost::system::error_code ignored;
    tcp::socket(context_).connect(acceptor_.local_endpoint(), ignored);  // wakes accept()
    thread_.join();
    const std::lock_guard lock(mutex_);
    connections_.clear();
  }
  LossyProxy(const LossyProxy&) = delete;
  LossyProxy& operator=(const LossyProxy&) = delete;

  int port() const { return acceptor_.local_endpoint().port(); }

 private:
  using tcp = boost::asio::ip::tcp;

  struct Connection {
    tcp::socket client, server;
    std::atomic<bool> loses_answer = false;
    std::thread up, down;

    Connection(tcp::socket from, LossyProxy& proxy)
        : client(std::move(from)), server(proxy.context_) {
      server.connect(
          {boost::asio::ip::address_v4::loopback(), static_cast<unsigned short>(proxy.port_)});
      up = std::thread([this, &proxy] {
        pass(client, server, [this, &proxy](std::string_view sent) {
          const Fate fate = proxy.ask_(sent);
          if (fate == Fate::kLoseAnswer) loses_answer = true;
          return fate != Fate::kLoseRequest;
        });
      });
      down = std::thread(
          [this] { pass(server, client, [this](std::string_view) { return !loses_answer; }); });
    }
    ~Connection() {
      end();
      up.join();
      down.join();
    }
    void end() {
      boost::system::error_code ignored;
      for (tcp::socket* socket : {&client, &server})
        socket->shutdown(tcp::socket::shutdown_both, ignored);
    }
    void pass(tcp::socket& from, tcp::socket& to,
              const std::function<bool(std::string_view)>& may_go_on) {
      std::array<char, 16384> bytes;
      boost::system::error_code error;
      for (;;) {
        const std::size_t count = from.read_some(boost::asio::buffer(bytes), error);
        if (error || !may_go_on({bytes.data(), count})) break;
        boost::asio::write(to, boost::asio::buffer(bytes.data(), count), error);
        if (error) break;
      }
      end();
    }
  };

  boost::asio::io_context context_;
  const int port_;
  const std::function<Fate(std::string_view)> ask_;
  std::atomic<bool> ends_ = false;
  std::mutex mutex_;
  std::list<Connection> connections_;
  tcp::acceptor acceptor_{context_, {boost::asio::ip::address_v4::loopback(), 0}};
  std::thread thread_;
};

}  // namespace hermite::test
