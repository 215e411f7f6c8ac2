// The part that all kinds of session (sessions.h) share.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"
#include "server/connections/sessions.h"

namespace hermite::server {

// Limits on the messages queued for a client. The server sends one result per frame, so only a
// client that does not read reaches them.
inline constexpr std::size_t kMaxWaitingMessages = 4096;
inline constexpr std::size_t kMaxWaitingBytes = 8 * 1024 * 1024;

// Queues messages in order, closes the connection, and refuses messages that do not belong to this
// kind of session. `wake` is called when there is something to send.
class BasicSession : public Session {
 public:
  explicit BasicSession(std::function<void()> wake) : wake_(std::move(wake)) {}

  void receive(std::string_view bytes) final {
    if (closing_) return;
    Result<wire::ClientMessage> message = wire::parse_client_message(bytes, max_message_bytes());
    if (!message.ok()) return fail(message.error(), close_code_of(message.error()));
    received_ = bytes;
    std::visit([this](auto& body) { handle(body); }, *message);
  }

  std::optional<Closing> closing() const override { return closing_; }

  void fail(const Error& error, CloseCode code) final {
    if (closing_) return;
    queue(format_error(error));
    close({code, error.message});
    failed(error);
  }

 protected:
  std::string_view received() const { return received_; }  // the message that is being handled
  void queue(std::string message) {
    if (closing_ && closing_->code == CloseCode::kSlow) return;
    // A single message may exceed the limit, for example the results of a scan.
    if (waiting_.size() >= kMaxWaitingMessages ||
        (waiting_bytes_ > 0 && waiting_bytes_ + message.size() > kMaxWaitingBytes)) {
      waiting_.clear();
      waiting_bytes_ = 0;
      return close({CloseCode::kSlow, "too many messages wait to be read by this client"});
    }
    waiting_bytes_ += message.size();
    waiting_.push_back(std::make_shared<const std::string>(std::move(message)));
    wake_();
  }
  SharedBytes next_waiting() {
    if (waiting_.empty()) return nullptr;
    SharedBytes message = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= message->size();
    return message;
  }
  void close(Closing closing) {
    if (!closing_) closing_ = std::move(closing);
    wake_();
  }
  // Called after fail(). Not called from within a callback of the scan.
  virtual void failed(const Error&) {}
  void wake() { wake_(); }
  void broken_rule(const std::string& message) {
    fail({ErrorCode::kInvalidArgument, message}, CloseCode::kProtocolError);
  }

  virtual void handle(wire::Frame&) {
    broken_rule("frame is a message of cameras; this connection is a viewer's");
  }
  virtual void handle(wire::Finish&) {
    broken_rule("finish is a message of cameras; this connection is a viewer's");
  }
  virtual void handle(wire::Pause&) {
    broken_rule("pause is a message of cameras; this connection is a viewer's");
  }
  virtual void handle(wire::Unpause&) {
    broken_rule("unpause is a message of cameras; this connection is a viewer's");
  }
  virtual void handle(wire::Discard&) {
    broken_rule("discard is a message of cameras; this connection is a viewer's");
  }
  virtual void handle(wire::Watch&) {
    broken_rule("watch is a message of viewers; this connection is a camera's");
  }
  virtual void handle(wire::ViewerAck&) {
    broken_rule("viewer_ack is a message of viewers; this connection is a camera's");
  }
  void handle(wire::Hello&) {
    broken_rule("hello came twice; it is the first message and no other");
  }
  void handle(wire::Ping& ping) { queue(wire::format_server_message(wire::Pong{ping.id})); }
  void handle(wire::Unknown&) {
    if (++unknown_count_ > kMaxUnknownMessages)
      fail({ErrorCode::kUnsupported,
            fmt::format("more than {} messages that this server does not know",
                        kMaxUnknownMessages)},
           CloseCode::kPolicy);
  }

 private:
  const std::function<void()> wake_;
  std::deque<SharedBytes> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::optional<Closing> closing_;
  int unknown_count_ = 0;
  std::string_view received_;
};

}  // namespace hermite::server
