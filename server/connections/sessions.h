// The protocol of a connection, independent of sockets: whole messages in, whole messages out, as
// bytes. The rules are in proto/README.md. Everything belongs to the network thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/access/gate.h"
#include "server/scan/scans.h"

namespace hermite::server {

// WebSocket close codes of RFC 6455, and those of this protocol from 4000 on.
enum class CloseCode : std::uint16_t {
  kNormal = 1000,
  kGoingAway = 1001,
  kProtocolError = 1002,
  kNotBinary = 1003,
  kCorrupt = 1007,
  kPolicy = 1008,
  kTooBig = 1009,
  kInternal = 1011,
  kUnauthorized = 4001,
  kForbidden = 4003,
  kNoSuchScan = 4004,
  kSlow = 4008,
  kSuperseded = 4009,
  kBusy = 4013,
};

// Returns the close code of a connection that ends with this error.
CloseCode close_code_of(const Error& error);

struct Closing {
  CloseCode code = CloseCode::kNormal;
  std::string reason;
};

// How many messages of unknown types a client may send.
inline constexpr int kMaxUnknownMessages = 1000;

// The server's side of a connection whose Hello was accepted.
class Session {
 public:
  virtual ~Session() = default;

  // Handles a whole binary message of at most max_message_bytes().
  virtual void receive(std::string_view message) = 0;
  virtual std::size_t max_message_bytes() const = 0;

  // Returns the next message to send; nullptr if there is none at the moment.
  virtual SharedBytes next() = 0;

  // Returns how to close the connection once next() returns nothing more; std::nullopt if it stays
  // open.
  virtual std::optional<Closing> closing() const = 0;

  // Sends the error to the client, then closes.
  virtual void fail(const Error& error, CloseCode code) = 0;

  // What the session does at the moment, and with which scan, for the audit log: "scan", "watch",
  // "wait", ... An empty id: no scan.
  virtual std::string what() const = 0;
  virtual std::string scan_id() const = 0;

  // The connection has ended. Nothing is received any more.
  virtual void disconnected() = 0;
};

struct Refusal {
  Error error;
  CloseCode code = CloseCode::kPolicy;
};

struct Greeted {
  std::unique_ptr<Session> session;
  Grant grant;  // the permissions of the session
};

// Returns what the secret of a Hello grants (Gate::admit).
using Admit = std::function<Result<Grant>(const std::string& secret)>;

// Handles the first message of a connection. `wake` is called on the network thread when the
// session may have something to send.
std::variant<Greeted, Refusal> greet(Scans& scans, const Admit& admit,
                                     std::string_view first_message, std::function<void()> wake);

// Returns the message for an error that does not concern a frame.
std::string format_error(const Error& error);

}  // namespace hermite::server
