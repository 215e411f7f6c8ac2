// Streams frames to a Hermite server and waits for the result: connect, hello, frames, finish, report. When the connection is lost, or the
// server ends and is started again, it connects anew and goes on where the server is.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "proto/wire/messages.h"
#include "server/client/flow_control.h"
#include "server/client/frame_source.h"
#include "server/client/server_url.h"

namespace hermite {

struct StreamRequest {
  ServerUrl server;  // with its token
  std::string ca;    // file with the certificate authorities to believe, empty: the system's
  std::string title;
  Pacing pacing;  // newest_wins asks the server for its live mode, and adapts what is sent to the link
  std::map<std::string, std::string> settings;
  std::chrono::milliseconds connect_patience{10'000};   // for the WebSocket, then for the welcome
  std::chrono::milliseconds silence_patience{120'000};  // without a word from a server that has something to do
  // So long it tries to get a lost connection back. More than the server's 120 s, which count from its start when it was down.
  std::chrono::milliseconds reconnect_patience{600'000};
};

struct StreamProgress {
  std::string scan_id;
  std::int64_t frame_count = 0;  // of the source, 0 when nobody knows
  std::uint64_t sent_frames = 0;
  std::uint64_t processed_frames = 0;       // results that came back
  std::uint64_t tracked_frames = 0;         // of these
  std::uint64_t dropped_frames = 0;         // here, for want of credit (live)
  std::uint64_t server_dropped_frames = 0;  // there (live)
  std::uint64_t left_out_frames = 0;        // here, because the link is too slow for all (live)
  std::uint64_t problem_frames = 0;         // could not be read here, or not be used there
  std::uint64_t unknown_messages = 0;       // of a newer server
  std::uint64_t durable_frames = 0;         // on the server's disk
  std::uint64_t resumed_count = 0;          // times that a lost connection was got back
  std::optional<double> round_trip_ms;      // of the last ping
  std::uint64_t sent_bytes = 0;
  std::optional<wire::FrameResult> last_result;
  std::string last_words;  // of the server about the finished scan; usually none
  int link_level = 0;      // what is sent of what there is (live): link_adaption.h
  bool finishing = false;  // no more frames will be sent
  double elapsed_s = 0;    // since the welcome
};

// Called on the thread of stream_frames; each may be empty.
struct StreamObserver {
  std::function<void(const StreamProgress&)> on_progress;    // several times a second
  std::function<void(const std::string& words)> on_problem;  // of one frame; the scan goes on
  std::function<void(const std::string& words)> on_link;     // the connection is lost, or back
  std::function<void(const wire::FrameResult&)> on_event;    // a result with an event
  std::function<int()> interrupt_count;                      // 1: send no more frames and finish. 2: give up
  std::function<bool()> paused;                              // no frames for now because a person wants it so: viewers are told
};

struct StreamOutcome {
  std::string report_json;     // as the server sent it
  std::string trajectory_tum;  // a line a frame that the server processed
  StreamProgress progress;     // at the end
};

// Blocks until the server's report is here or the scan has failed. Encodes on a second thread, which takes the frames of `source`.
// Errors in words: those of Connection::open; what the server says when it ends the scan, or why it does not go on with it; the end of the
// connection before the report, when it could not be got back; silence beyond the patience; kTooLarge for a frame above the server's limit
// for a message; kIo when given up by interrupt.
Result<StreamOutcome> stream_frames(FrameSource& source, const StreamRequest& request, const StreamObserver& observer);

// The same with the frames of a recording.
Result<StreamOutcome> stream_sequence(const Sequence& sequence, const FrameRange& frames, const StreamRequest& request,
                                      const StreamObserver& observer);

}  // namespace hermite
