// What the two ends of a connection say to each other, apart from sockets: bytes of whole messages in, bytes of whole messages out.
// The rules are those of proto/README.md. Everything belongs to the network thread.
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

namespace hermite {

// WebSocket close codes (RFC 6455) and ours.
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

// With which a connection ends for that error.
CloseCode close_code_of(const Error& error);

struct Closing {
  CloseCode code = CloseCode::kNormal;
  std::string words;
};

// A client may send this many messages that this server does not know.
inline constexpr int kMaxUnknownMessages = 1000;

// The server's side of one connection after its Hello was accepted.
class Session {
 public:
  virtual ~Session() = default;

  // A whole binary message, at most max_message_bytes() long.
  virtual void receive(std::string_view message) = 0;
  virtual std::size_t max_message_bytes() const = 0;

  // The next message to send, none when there is nothing at the moment.
  virtual SharedBytes next() = 0;

  // Set when the connection is to be closed, once next() has nothing more.
  virtual std::optional<Closing> closing() const = 0;

  // Tells the client in words, then closes.
  virtual void fail(const Error& error, CloseCode code) = 0;

  // What it does with which scan at the moment, for the audit log: "scan", "watch", "wait", ...; empty id: with none.
  virtual std::string what() const = 0;
  virtual std::string scan_id() const = 0;

  // The connection is gone. Nothing is received any more.
  virtual void disconnected() = 0;
};

struct Refusal {
  Error error;
  CloseCode code = CloseCode::kPolicy;
};

struct Greeted {
  std::unique_ptr<Session> session;
  Grant grant;  // that the session rests on
};

// What the secret of a hello allows (Gate::admit).
using Admit = std::function<Result<Grant>(const std::string& secret)>;

// Answers the first message of a connection. `wake` is called, on the network thread, when the session may have something to send.
std::variant<Greeted, Refusal> greet(Scans& scans, const Admit& admit, std::string_view first_message, std::function<void()> wake);

// The message of an Error that is not about a frame.
std::string format_error(const Error& error);

}  // namespace hermite
