// What the server has answered in the course of a streamed scan, over one connection after another.
// Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/client/flow_control.h"
#include "server/client/link.h"
#include "server/client/outgoing_frames.h"
#include "server/client/stream_report.h"

namespace hermite::client {

class ServerAnswers {
 public:
  // Who else is told of answers: the frames of credit, the link of pongs, the report of results and
  // messages. All outlive this.
  struct Concerned {
    OutgoingFrames& frames;
    Link& link;
    StreamReport& report;
  };
  explicit ServerAnswers(const Concerned& concerned) : concerned_(concerned) {}

  // Takes a message that came over the present connection. Errors as wire::parse_server_message.
  Status take(const std::string& bytes, SteadyTime now);

  // From here on messages come over a new connection.
  void connected(SteadyTime now);

  // Answers about the scan, over any connection. std::nullopt: not received yet.
  const std::optional<wire::Welcome>& welcome() const { return welcome_; }  // the first one
  SteadyTime welcomed_at() const { return welcomed_at_; }
  bool is_resumable() const { return welcome_ && !welcome_->resume_token.empty(); }
  const std::optional<wire::Finished>& finished() const { return finished_; }
  // The server has ended the scan, or does not go on with it.
  const std::optional<Error>& failure() const { return failure_; }
  // Somebody who watches has asked for a pause.
  bool holds_frames() const { return holds_frames_; }
  // When the server last sent anything but a Pong, or a connection was made.
  SteadyTime last_news() const { return last_news_; }

  // Answers over the present connection.
  const std::optional<wire::Resumed>& resumed() const { return resumed_; }
  // The scan waits for admission by the server.
  const std::optional<wire::Waiting>& waiting() const { return waiting_; }
  // When the server last said that the scan waits, over any connection.
  SteadyTime waiting_said_at() const { return waiting_said_at_; }

  // Whether the server has said that it stops. It also says for how long to stay away, which
  // take_stay_away() returns once, to a caller that then waits.
  bool is_stopping() const { return stay_away_.has_value(); }
  std::chrono::milliseconds take_stay_away();  // 0: it has not said so

 private:
  struct Reader;

  const Concerned concerned_;
  std::optional<wire::Welcome> welcome_;
  SteadyTime welcomed_at_, last_news_, waiting_said_at_;
  std::optional<wire::Finished> finished_;
  std::optional<Error> failure_;
  bool holds_frames_ = false;
  std::uint64_t next_result_ = 0;  // earlier results were received; a rebuilt scan sends them again
  std::optional<wire::Resumed> resumed_;
  std::optional<wire::Waiting> waiting_;
  std::optional<std::chrono::milliseconds> stay_away_;
};

}  // namespace hermite::client
