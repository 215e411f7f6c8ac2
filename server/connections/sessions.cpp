#include "server/connections/sessions.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"
#include "server/connections/basic_session.h"

namespace hermite::server {

namespace {

constexpr const char* kServerName = "hermite " HERMITE_VERSION;

// A restarted server is available again sooner than this.
constexpr std::uint32_t kResumeAfter_ms = 1000;

class CameraSession final : public BasicSession {
 public:
  struct Terms {
    std::size_t max_message_bytes = 0;
    bool can_pause = false;
  };

  // `greeting`: Welcome or Resumed.
  CameraSession(std::shared_ptr<LiveScan> scan, wire::ServerMessage greeting, const Terms& terms,
                std::function<void()> wake)
      : BasicSession(std::move(wake)),
        scan_(std::move(scan)),
        max_message_bytes_(terms.max_message_bytes) {
    queue(wire::format_server_message(std::move(greeting)));
    CameraLink link;
    link.send = [this](wire::ServerMessage message) {
      queue(wire::format_server_message(std::move(message)));
    };
    link.ended = [this] { close({CloseCode::kNormal, "the scan has ended"}); };
    link.superseded = [this] {
      fail({ErrorCode::kBusy, "another connection goes on with this scan"}, CloseCode::kSuperseded);
    };
    link.go_away = [this] {
      queue(wire::format_server_message(wire::GoAway{kResumeAfter_ms}));
      close({CloseCode::kGoingAway,
             "the server is stopping; the scan goes on when there is one again"});
    };
    link.can_pause = terms.can_pause;
    link_ = scan_->attach_camera(std::move(link));
  }

  std::size_t max_message_bytes() const override { return max_message_bytes_; }
  SharedBytes next() override { return next_waiting(); }
  std::string what() const override { return "scan"; }
  std::string scan_id() const override { return scan_->subscribers()->info().scan_id; }

  void disconnected() override {
    // The server may have dropped a scan that has ended already; `scan_` keeps it alive until here.
    scan_->camera_left(
        link_, {ErrorCode::kIo, "the camera's connection ended before it had finished"}, false);
  }

 private:
  void handle(wire::Frame& frame) override {
    if (Status status = scan_->receive(std::move(frame), received()); !status.ok())
      fail(status.error(), close_code_of(status.error()));
  }
  void handle(wire::Finish&) override { scan_->finish(); }
  void handle(wire::Pause&) override { scan_->pause(true); }
  void handle(wire::Unpause&) override { scan_->pause(false); }
  void handle(wire::Discard&) override { scan_->discard(); }
  // Leave at once, since a client may be slow to close the socket. An expired or revoked token is
  // not a violation of the protocol: the camera may come back with another token.
  void failed(const Error& error) override {
    scan_->camera_left(link_, error, error.code != ErrorCode::kUnauthorized);
  }

  const std::shared_ptr<LiveScan> scan_;
  const std::size_t max_message_bytes_;
  std::uint64_t link_ = 0;
};

// For a camera whose scan cannot be resumed: sends the remaining messages and closes.
class FarewellSession final : public BasicSession {
 public:
  FarewellSession(std::vector<wire::ServerMessage> messages, Closing closing,
                  std::function<void()> wake)
      : BasicSession(std::move(wake)) {
    for (wire::ServerMessage& message : messages)
      queue(wire::format_server_message(std::move(message)));
    close(std::move(closing));
  }
  std::size_t max_message_bytes() const override { return wire::kMaxBytesBeforeWelcome; }
  SharedBytes next() override { return next_waiting(); }
  std::string what() const override { return "come back in vain"; }
  std::string scan_id() const override { return {}; }
  void disconnected() override {}
};

class ViewerSession final : public BasicSession {
 public:
  ViewerSession(std::unique_ptr<Viewer> viewer, wire::Welcome welcome, std::function<void()> wake)
      : BasicSession(std::move(wake)), viewer_(std::move(viewer)), scan_id_(welcome.scan_id) {
    queue(wire::format_server_message(std::move(welcome)));
  }

  std::size_t max_message_bytes() const override { return wire::kMaxBytesBeforeWelcome; }

  SharedBytes next() override {
    if (SharedBytes message = next_waiting()) {
      viewer_->count_sent(message->size());
      return message;
    }
    return BasicSession::closing() ? nullptr : viewer_->next();
  }

  std::optional<Closing> closing() const override {
    if (BasicSession::closing()) return BasicSession::closing();
    if (viewer_->complete())
      return Closing{CloseCode::kNormal, "the scan has ended and was sent whole"};
    return std::nullopt;
  }

  std::string what() const override { return "watch"; }
  std::string scan_id() const override { return scan_id_; }
  void disconnected() override {}

 private:
  void handle(wire::ViewerAck& ack) override {
    if (Status status = viewer_->acknowledge(ack.bytes); !status.ok())
      return fail(status.error(), CloseCode::kProtocolError);
    wake();
  }
  void handle(wire::Watch& watch) override {
    viewer_->watch(watch);
    wake();
  }

  const std::unique_ptr<Viewer> viewer_;
  const std::string scan_id_;
};

Refusal refusal_of(const Error& error) { return {error, close_code_of(error)}; }

wire::Welcome complete_welcome(wire::Welcome welcome) {
  welcome.server = kServerName;
  welcome.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
  return welcome;
}

using Greeting = std::variant<std::unique_ptr<Session>, Refusal>;

// Session of a client that has to wait for its admission or for a log that is read from disk: once
// that is done, it acts as the real session.
class WaitingSession final : public Session {
 public:
  using Begin = std::function<Greeting()>;

  // `begin` is called when the wait has ended.
  WaitingSession(Begin begin, std::function<void()> wake)
      : begin_(std::move(begin)), session_(std::make_unique<WaitingRoom>(std::move(wake))) {}

  Status wait_for_place(Places& places, const PlaceRequest& request) {
    auto& room = static_cast<WaitingRoom&>(*session_);
    Result<Places::Ticket> ticket = places.wait(
        request, [&room](const wire::Waiting& waiting) { room.tell(waiting); },
        [this] { begin(); });
    if (!ticket.ok()) return ticket.error();
    leave_ = [&places, number = *ticket] { places.leave(number); };
    return Done{};
  }

  void wait_for_log(LogReaders& logs, const std::string& scan_id) {
    const LogReaders::Ticket ticket = logs.when_read(scan_id, [this] { begin(); });
    leave_ = [&logs, ticket] { logs.forget(ticket); };
  }

  void wait_for_results(Scans& scans, const std::string& scan_id) {
    const ShownScans::Ticket ticket = scans.shown().when_shown(scan_id, [this] { begin(); });
    leave_ = [&scans, ticket] { scans.shown().cancel(ticket); };
  }

  void wait_for_last_messages(Scans& scans, const wire::ResumeScan& request,
                              const std::shared_ptr<EndedScans::LastMessages>& messages) {
    const EndedScans::Ticket ticket =
        scans.ended_scans().when_told(request, [this, messages](EndedScans::LastMessages told) {
          *messages = std::move(told);
          begin();
        });
    leave_ = [&scans, ticket] { scans.ended_scans().forget(ticket); };
  }

  void receive(std::string_view message) override { session_->receive(message); }
  std::size_t max_message_bytes() const override { return session_->max_message_bytes(); }
  SharedBytes next() override { return session_->next(); }
  std::optional<Closing> closing() const override { return session_->closing(); }
  std::string what() const override { return session_->what(); }
  std::string scan_id() const override { return session_->scan_id(); }
  void fail(const Error& error, CloseCode code) override {
    stop_waiting();
    session_->fail(error, code);
  }
  void disconnected() override {
    stop_waiting();
    session_->disconnected();
  }

 private:
  class WaitingRoom final : public BasicSession {
   public:
    using BasicSession::BasicSession;
    void tell(const wire::Waiting& waiting) { queue(wire::format_server_message(waiting)); }
    std::size_t max_message_bytes() const override { return wire::kMaxBytesBeforeWelcome; }
    SharedBytes next() override { return next_waiting(); }
    std::string what() const override { return "wait"; }
    std::string scan_id() const override { return {}; }
    void disconnected() override {}

   private:
    void handle(wire::Frame&) override { broken_rule("a frame before the welcome"); }
  };

  void begin() {
    leave_ = nullptr;
    if (session_->closing()) return;  // it violated a rule while it waited
    Greeting greeting = begin_();
    if (const Refusal* refusal = std::get_if<Refusal>(&greeting))
      return session_->fail(refusal->error, refusal->code);
    session_ = std::get<std::unique_ptr<Session>>(std::move(greeting));
  }
  void stop_waiting() {
    if (leave_) leave_();
    leave_ = nullptr;
  }

  const Begin begin_;
  std::function<void()> leave_;  // leaves the queue; empty: it is not in a queue any more
  std::unique_ptr<Session> session_;
};

Greeting start_scan(Scans& scans, const Grant& grant, const wire::Hello& hello,
                    std::function<void()> wake) {
  Result<StartedScan> started = scans.start(std::get<wire::StartScan>(hello.role), grant,
                                            hello.protocol_minor >= wire::kMinorWithResume);
  if (!started.ok()) return refusal_of(started.error());
  const CameraSession::Terms terms{started->welcome.max_message_bytes,
                                   hello.protocol_minor >= wire::kMinorWithPauseRequest};
  return std::make_unique<CameraSession>(std::move(started->scan),
                                         complete_welcome(std::move(started->welcome)), terms,
                                         std::move(wake));
}

Greeting go_away(const std::string& why, std::function<void()> wake) {
  return std::make_unique<FarewellSession>(
      std::vector<wire::ServerMessage>{wire::GoAway{kResumeAfter_ms}},
      Closing{CloseCode::kGoingAway, why}, std::move(wake));
}

Greeting greet_camera(Scans& scans, const Grant& grant, const wire::Hello& hello,
                      std::function<void()> wake) {
  const PlaceRequest request = place_request_of(grant, std::get<wire::StartScan>(hello.role).mode);
  const Status place = scans.places().check_for_newcomer(request);
  if (place.ok()) return start_scan(scans, grant, hello, std::move(wake));
  if (hello.protocol_minor < wire::kMinorWithWaiting)
    return refusal_of(in_context("try again later", place.error()));
  auto begin = [&scans, grant, hello, wake] {
    return scans.is_stopping() ? go_away("the server is stopping", wake)
                               : start_scan(scans, grant, hello, wake);
  };
  auto waiting = std::make_unique<WaitingSession>(std::move(begin), wake);
  if (Status status = waiting->wait_for_place(scans.places(), request); !status.ok())
    return refusal_of(status.error());
  spdlog::info("a camera waits for a place: {}", place.error().message);
  return waiting;
}

Greeting not_resumed(const Error& why, std::function<void()> wake) {
  // The camera may try later, or with the next server.
  if (why.code == ErrorCode::kBusy || why.code == ErrorCode::kUnavailable)
    return go_away(why.message, std::move(wake));
  spdlog::info("a camera cannot resume: {}", why.message);
  return std::make_unique<FarewellSession>(
      std::vector<wire::ServerMessage>{wire::NotResumed{why.message}},
      Closing{close_code_of(why), why.message}, std::move(wake));
}

Greeting tell_last_messages(Scans& scans, const wire::ResumeScan& request,
                            std::function<void()> wake) {
  const auto messages =
      std::make_shared<EndedScans::LastMessages>(std::vector<wire::ServerMessage>());
  auto begin = [messages, wake]() -> Greeting {
    if (!messages->ok()) return not_resumed(messages->error(), wake);
    return std::make_unique<FarewellSession>(
        *std::move(*messages), Closing{CloseCode::kNormal, "the scan has ended"}, wake);
  };
  auto waiting = std::make_unique<WaitingSession>(std::move(begin), wake);
  waiting->wait_for_last_messages(scans, request, messages);
  return waiting;
}

Greeting resume_scan(Scans& scans, const wire::Hello& hello, std::function<void()> wake) {
  const auto& request = std::get<wire::ResumeScan>(hello.role);
  Result<std::optional<ResumedScan>> found = scans.resume(request);
  if (!found.ok()) return not_resumed(found.error(), std::move(wake));
  if (!*found) return tell_last_messages(scans, request, std::move(wake));
  const auto& [scan, resumed, max_message_bytes] = **found;
  spdlog::info("the camera of scan {} is back, from frame {} on", request.scan_id,
               resumed.next_sequence);
  const CameraSession::Terms terms{max_message_bytes,
                                   hello.protocol_minor >= wire::kMinorWithPauseRequest};
  return std::make_unique<CameraSession>(scan, resumed, terms, std::move(wake));
}

// After a restart of the server, the log of the scan may still have to be read, which is usually
// quick.
Greeting greet_returning_camera(Scans& scans, const wire::Hello& hello,
                                std::function<void()> wake) {
  const std::string& scan_id = std::get<wire::ResumeScan>(hello.role).scan_id;
  if (!scans.logs().is_waited_for(scan_id)) return resume_scan(scans, hello, std::move(wake));
  auto waiting = std::make_unique<WaitingSession>(
      [&scans, hello, wake] { return resume_scan(scans, hello, wake); }, wake);
  waiting->wait_for_log(scans.logs(), scan_id);
  return waiting;
}

Greeting greet_viewer(Scans& scans, const Grant& grant, const wire::ViewScan& request,
                      std::function<void()> wake) {
  Result<std::shared_ptr<Subscribers>> subscribers = scans.watch(request.scan_id);
  if (!subscribers.ok()) return refusal_of(subscribers.error());
  if (!*subscribers) {
    auto waiting = std::make_unique<WaitingSession>(
        [&scans, grant, request, wake] { return greet_viewer(scans, grant, request, wake); }, wake);
    waiting->wait_for_results(scans, request.scan_id);
    return waiting;
  }
  Result<std::unique_ptr<Viewer>> viewer = Subscribers::join(
      *subscribers, {grant.token_id, may(grant, Scope::kAdmin)}, request.watch, wake);
  if (!viewer.ok()) return refusal_of(viewer.error());
  const SceneInfo& info = (*subscribers)->info();
  wire::Welcome welcome;
  welcome.scan_id = info.scan_id;
  welcome.title = info.title;
  welcome.camera = info.camera;
  welcome.max_message_bytes = wire::kMaxBytesBeforeWelcome;
  return std::make_unique<ViewerSession>(*std::move(viewer), complete_welcome(std::move(welcome)),
                                         std::move(wake));
}

Greeting greet_role(Scans& scans, const Grant& grant, const wire::Hello& hello,
                    std::function<void()> wake) {
  const auto* view = std::get_if<wire::ViewScan>(&hello.role);
  const auto* resume = std::get_if<wire::ResumeScan>(&hello.role);
  const Scope needed = view ? Scope::kView : Scope::kScan;
  if (!may(grant, needed)) return Refusal{lacks(grant, needed), CloseCode::kForbidden};
  if (!view && !resume) return greet_camera(scans, grant, hello, std::move(wake));
  const std::string& scan_id = view ? view->scan_id : resume->scan_id;
  if (!concerns(grant, scan_id))
    return refusal_of({ErrorCode::kNotFound, "there is no scan " + scan_id});
  return view ? greet_viewer(scans, grant, *view, std::move(wake))
              : greet_returning_camera(scans, hello, std::move(wake));
}

}  // namespace

std::string format_error(const Error& error) {
  return wire::format_server_message(
      wire::ErrorMessage{name_of(error.code), error.message, false, 0});
}

std::variant<Greeted, Refusal> greet(Scans& scans, const Admit& admit,
                                     std::string_view first_message, std::function<void()> wake) {
  const Result<wire::ClientMessage> message =
      wire::parse_client_message(first_message, wire::kMaxBytesBeforeWelcome);
  if (!message.ok()) return refusal_of(message.error());
  const wire::Hello* hello = std::get_if<wire::Hello>(&*message);
  if (!hello) return refusal_of({ErrorCode::kInvalidArgument, "the first message must be a hello"});
  Result<Grant> grant = admit(hello->token);
  if (!grant.ok()) return refusal_of(in_context("hello.token", grant.error()));
  Greeting greeting = greet_role(scans, *grant, *hello, std::move(wake));
  if (Refusal* refusal = std::get_if<Refusal>(&greeting)) return std::move(*refusal);
  return Greeted{std::get<std::unique_ptr<Session>>(std::move(greeting)), *std::move(grant)};
}

}  // namespace hermite::server
