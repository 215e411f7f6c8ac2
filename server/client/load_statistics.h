// What a load test has measured, and its statistics. Plain values, pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace hermite::client {

using MessageCounts = std::map<std::string, std::uint64_t>;

// Different ones; the others are counted together.
inline constexpr std::size_t kMaxLoadMessages = 50;

// Counts a message, shortened to 300 bytes, and without control characters, since it is another's
// and goes to a terminal.
void count_message(MessageCounts& counts, const std::string& message);
void add_messages(MessageCounts& to, const MessageCounts& from);

struct TimeSummary {
  std::uint64_t count = 0;  // the others are 0 if this is 0
  double median = 0, p95 = 0, p99 = 0, largest = 0;
};

// The percentile p of n values is the smallest of them that is not exceeded by p percent of all:
// the value of rank ceil(p n / 100), always one that was measured.
TimeSummary summary_of(std::vector<float> values);

// Of one camera, all of its scans together.
struct CameraLoad {
  // Failed: begun, but without the server's report.
  std::uint64_t scans_begun = 0, scans_finished = 0, scans_failed = 0;
  // Attempts that began no scan.
  std::uint64_t refused = 0;
  std::uint64_t due = 0, offered = 0;  // OfferedFrames
  std::uint64_t sent = 0, answered = 0, tracked = 0;
  std::uint64_t client_dropped = 0, server_dropped = 0, left_out = 0;
  std::uint64_t problem_frames = 0, reconnects = 0, sent_bytes = 0;
  std::vector<float> answer_ms;
  // Time that it waited for a place, each time that it had to, the last one maybe in vain.
  std::vector<float> wait_s;
  bool without_place = false;     // it was waiting when the time was over
  MessageCounts refusals, other;  // other: why a scan failed, and what was wrong with frames
};

CameraLoad sum_of(const std::vector<CameraLoad>& cameras);

// Has it streamed at least one scan to the end, and none that failed?
bool got_through(const CameraLoad& camera);

// The share of the offered frames that has no answer: dropped by either end, left out, or not
// answered at the end. 0 if none was offered.
double unanswered_share(const CameraLoad& camera);
double tracked_share(const CameraLoad& camera);  // of the answered frames; 0 if there are none

// Of all viewers of one thread, or of a test.
struct ViewerLoad {
  std::uint64_t watched = 0;  // scans that a viewer was welcomed to
  std::uint64_t refused = 0, disconnected = 0;
  std::uint64_t messages = 0, received_bytes = 0, sent_bytes = 0;
  double watched_s = 0;            // the sum over viewers, from the welcome to the end
  std::vector<float> snapshot_ms;  // from connecting to SnapshotEnd
  MessageCounts problems;          // of those refused or disconnected
  double busiest_thread = 0;       // its share of one core
};

ViewerLoad sum_of(const std::vector<ViewerLoad>& threads);

// Of the machine that the load test ran on.
struct LoadMachine {
  int cores = 0;
  double cores_used = 0;        // by the load test itself, mean over the test
  bool has_server_too = false;  // or the end of a tunnel to it
};

struct LoadCleaning {
  std::uint64_t deleted = 0;
  std::vector<std::string> left;  // ids
  std::string why_left;           // for people; empty if none is left
};

struct LoadResult {
  int camera_count = 0, viewer_count = 0;
  double rate_hz = 0;
  double seconds = 0;        // how long the load lasted
  bool interrupted = false;  // before its time was over
  std::vector<CameraLoad> cameras;
  ViewerLoad viewers;
  LoadMachine machine;
  LoadCleaning cleaning;
};

bool all_got_through(const LoadResult& result);

}  // namespace hermite::client
