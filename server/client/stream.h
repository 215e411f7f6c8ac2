// Streams frames to a Hermite server and waits for the result: connects, sends Hello, frames and
// Finish, and receives the report. If the connection is lost, or the server is restarted, it
// reconnects and continues where the server is.
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

namespace hermite::client {

struct StreamRequest {
  ServerUrl server;  // with its token
  std::string ca;    // file with the certificate authorities to trust; empty: the system's
  std::string title;
  // newest_wins requests the live mode of the server, and adapts the stream to the link.
  Pacing pacing;
  std::map<std::string, std::string> settings;
  std::chrono::milliseconds connect_patience{10'000};  // for the WebSocket, then for the Welcome
  // Time without any message from a server that has work to do.
  std::chrono::milliseconds silence_patience{120'000};
  // How long to try to reconnect. Longer than the server's 120 s, which count from its start if it
  // was down.
  std::chrono::milliseconds reconnect_patience{600'000};
};

struct StreamProgress {
  std::string scan_id;
  std::int64_t frame_count = 0;  // of the source; 0: unknown
  std::uint64_t sent_frames = 0;
  std::uint64_t processed_frames = 0;       // results received
  std::uint64_t tracked_frames = 0;         // of these
  std::uint64_t dropped_frames = 0;         // by the client for lack of credit (live)
  std::uint64_t server_dropped_frames = 0;  // by the server (live)
  // Frames left out by the client, because the link is too slow for all (live).
  std::uint64_t left_out_frames = 0;
  // Not readable by the client, or not usable by the server.
  std::uint64_t problem_frames = 0;
  std::uint64_t unknown_messages = 0;   // from a newer server
  std::uint64_t durable_frames = 0;     // on the server's disk
  std::uint64_t resumed_count = 0;      // how often a lost connection was resumed
  std::optional<double> round_trip_ms;  // of the last ping
  std::uint64_t sent_bytes = 0;
  std::optional<wire::FrameResult> last_result;
  std::string last_message;  // the server's remarks about the finished scan; usually empty
  int link_level = 0;        // current level of the adaption to the link (live): link_adaption.h
  bool finishing = false;    // no more frames will be sent
  double elapsed_s = 0;      // since the Welcome
};

// Called on the thread of stream_frames; each may be empty.
struct StreamObserver {
  std::function<void(const StreamProgress&)> on_progress;  // several times per second
  // About one frame; the scan continues.
  std::function<void(const std::string& message)> on_problem;
  std::function<void(const std::string& message)> on_link;  // the connection was lost or resumed
  std::function<void(const wire::FrameResult&)> on_event;   // a result with an event
  // 1: send no more frames and finish. 2: abort.
  std::function<int()> interrupt_count;
  // No frames for now, because the user has paused the scan; viewers are told.
  std::function<bool()> paused;
  // Somebody who watches asks for a pause, or for its end. If this is empty, the frames of the
  // source wait meanwhile.
  std::function<void(bool paused)> on_pause_request;
};

// What a client tells its user when somebody who watches has asked for it.
inline constexpr const char* kPausedByViewer = "paused from the viewer";
inline constexpr const char* kUnpausedByViewer = "goes on, as the viewer asked";

struct StreamOutcome {
  std::string report_json;     // as received from the server
  std::string trajectory_tum;  // one line per frame that the server processed
  StreamProgress progress;     // at the end
};

// Blocks until the server's report has arrived or the scan has failed. A second thread takes the
// frames of `source` and encodes them. Errors, with a message: those of Connection::open; the
// server's message when it ends the scan or does not resume it; a connection that ended before the
// report and could not be resumed; silence for longer than `silence_patience`; kTooLarge for a
// frame above the server's message limit; kIo if aborted by interrupt.
Result<StreamOutcome> stream_frames(FrameSource& source, const StreamRequest& request,
                                    const StreamObserver& observer);

// The same for the frames of a recording.
Result<StreamOutcome> stream_sequence(const dataset::Sequence& sequence,
                                      const dataset::FrameRange& frames,
                                      const StreamRequest& request, const StreamObserver& observer);

}  // namespace hermite::client
