// A client made of bytes, for what no decent client would send: HTTP and WebSocket frames by hand
// over a plain socket. Every read ends after a minute of silence, and after five of nothing but
// pings. Header only.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"

namespace hermite::test {

class RawClient {
 public:
  struct Frame {
    int opcode = 0;  // 1 text, 2 binary, 8 close, 9 ping
    std::string payload;
  };

  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval limit{60, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no connection");
  }
  ~RawClient() { drop(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // Without a word, as a client that is killed.
  void drop() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }

  // What the other side does not take any more is lost.
  void send(const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;
      sent += static_cast<std::size_t>(count);
    }
  }

  // Up to and with the empty line behind a header; all there is when the connection ends first.
  std::string read_header() {
    while (buffer_.find("\r\n\r\n") == std::string::npos && fill()) {
    }
    const std::size_t end = std::min(buffer_.find("\r\n\r\n"), buffer_.size() - 4) + 4;
    return take(buffer_.size() < 4 ? buffer_.size() : end);
  }

  std::string read_to_end() {
    while (fill()) {
    }
    return take(buffer_.size());
  }

  // The header of the answer to an upgrade with these headers ("Name: value\r\n"...).
  std::string upgrade(const std::string& headers, const std::string& path = wire::kEndpoint) {
    send("GET " + path +
         " HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" +
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" + headers + "\r\n");
    return read_header();
  }
  bool upgrade() {
    return upgrade("Host: localhost\r\nSec-WebSocket-Protocol: hermite.v1\r\n").find(" 101 ") !=
           std::string::npos;
  }

  void send_frame(int opcode, const std::string& payload) {
    std::string bytes(1, static_cast<char>(0x80 | opcode));
    const std::uint64_t length = payload.size();
    const int length_bytes = length < 126 ? 0 : length < 65536 ? 2 : 8;
    bytes += static_cast<char>(0x80 | (length < 126        ? static_cast<int>(length)
                                       : length_bytes == 2 ? 126
                                                           : 127));
    for (int i = length_bytes - 1; i >= 0; --i) bytes += static_cast<char>(length >> (8 * i));
    bytes += std::string(4, '\0');  // the mask: clients must have one, zeros are one
    send(bytes + payload);
  }
  void send_message(wire::ClientMessage message) {
    send_frame(2, wire::format_client_message(std::move(message)));
  }

  // Nothing when the connection ended.
  std::optional<Frame> read_frame() {
    if (!need(2)) return std::nullopt;
    const std::string head = take(2);
    std::uint64_t length = static_cast<unsigned char>(head[1]) & 0x7f;
    const int length_bytes = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (length_bytes > 0) {
      if (!need(static_cast<std::size_t>(length_bytes))) return std::nullopt;
      length = 0;
      for (const char byte : take(static_cast<std::size_t>(length_bytes)))
        length = length << 8 | static_cast<unsigned char>(byte);
    }
    if (!need(length)) return std::nullopt;
    return Frame{static_cast<unsigned char>(head[0]) & 0x0f, take(length)};
  }

  // The next binary message; nothing when there is none any more. Pings are answered.
  std::optional<wire::ServerMessage> read_message() {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    while (std::optional<Frame> frame =
               std::chrono::steady_clock::now() < limit ? read_frame() : std::nullopt) {
      received_bytes_ += frame->opcode == 2 ? frame->payload.size() : 0;
      if (frame->opcode == 2) return *wire::parse_server_message(frame->payload);
      if (frame->opcode == 9) send_frame(10, frame->payload);
      if (frame->opcode == 8) {
        const std::string& code = frame->payload;
        close_code_ = code.size() < 2 ? 1005
                                      : static_cast<unsigned char>(code[0]) << 8 |
                                            static_cast<unsigned char>(code[1]);
        send_frame(8, frame->payload.substr(0, 2));
        return std::nullopt;
      }
    }
    return std::nullopt;
  }

  // The next message of that kind; others are left out. Nothing when the connection ended.
  template <class Body>
  std::optional<Body> read() {
    while (const std::optional<wire::ServerMessage> message = read_message())
      if (const Body* body = std::get_if<Body>(&*message)) return *body;
    return std::nullopt;
  }

  // Reads to the end; the code of the close frame, 0 when there was none.
  int close_code() {
    while (read_message()) {
    }
    return close_code_;
  }

  std::uint64_t received_bytes() const { return received_bytes_; }  // of messages

 private:
  bool fill() {
    char bytes[65536];
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    if (count > 0) buffer_.append(bytes, static_cast<std::size_t>(count));
    return count > 0;
  }
  bool need(std::size_t count) {
    while (buffer_.size() < count)
      if (!fill()) return false;
    return true;
  }
  std::string take(std::size_t count) {
    std::string taken = buffer_.substr(0, count);
    buffer_.erase(0, count);
    return taken;
  }

  int socket_;
  std::string buffer_;
  int close_code_ = 0;
  std::uint64_t received_bytes_ = 0;
};

}  // namespace hermite::test
