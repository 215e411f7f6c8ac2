#include "server/client/load_statistics.h"

#include <algorithm>
#include <cmath>

#include "core/base/utf8.h"

namespace hermite::client {

namespace {

constexpr std::size_t kMaxMessageBytes = 300;
constexpr const char* kOtherMessages = "other messages";

void add_times(MessageCounts& counts, const std::string& message, std::uint64_t times) {
  const bool room = counts.size() < kMaxLoadMessages || counts.contains(message);
  counts[room ? message : kOtherMessages] += times;
}

float percentile(std::vector<float>& values, double percent) {
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(percent * static_cast<double>(values.size()) / 100));
  const auto nth = values.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

void append(std::vector<float>& to, const std::vector<float>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void count_message(MessageCounts& counts, const std::string& message) {
  std::string printable = message.substr(0, kMaxMessageBytes);
  std::replace_if(printable.begin(), printable.end(), is_control, '?');
  add_times(counts, printable, 1);
}

void add_messages(MessageCounts& to, const MessageCounts& from) {
  for (const auto& [message, times] : from) add_times(to, message, times);
}

TimeSummary summary_of(std::vector<float> values) {
  if (values.empty()) return {};
  return {values.size(), percentile(values, 50), percentile(values, 95), percentile(values, 99),
          *std::max_element(values.begin(), values.end())};
}

CameraLoad sum_of(const std::vector<CameraLoad>& cameras) {
  CameraLoad sum;
  for (const CameraLoad& camera : cameras) {
    sum.scans_begun += camera.scans_begun;
    sum.scans_finished += camera.scans_finished;
    sum.scans_failed += camera.scans_failed;
    sum.refused += camera.refused;
    sum.due += camera.due;
    sum.offered += camera.offered;
    sum.sent += camera.sent;
    sum.answered += camera.answered;
    sum.tracked += camera.tracked;
    sum.client_dropped += camera.client_dropped;
    sum.server_dropped += camera.server_dropped;
    sum.left_out += camera.left_out;
    sum.problem_frames += camera.problem_frames;
    sum.reconnects += camera.reconnects;
    sum.sent_bytes += camera.sent_bytes;
    append(sum.answer_ms, camera.answer_ms);
    append(sum.wait_s, camera.wait_s);
    sum.without_place = sum.without_place || camera.without_place;
    add_messages(sum.refusals, camera.refusals);
    add_messages(sum.other, camera.other);
  }
  return sum;
}

bool got_through(const CameraLoad& camera) {
  return camera.scans_finished > 0 && camera.scans_failed == 0;
}

double unanswered_share(const CameraLoad& camera) {
  return share(camera.offered - std::min(camera.answered, camera.offered), camera.offered);
}

double tracked_share(const CameraLoad& camera) { return share(camera.tracked, camera.answered); }

ViewerLoad sum_of(const std::vector<ViewerLoad>& threads) {
  ViewerLoad sum;
  for (const ViewerLoad& thread : threads) {
    sum.watched += thread.watched;
    sum.refused += thread.refused;
    sum.disconnected += thread.disconnected;
    sum.messages += thread.messages;
    sum.received_bytes += thread.received_bytes;
    sum.sent_bytes += thread.sent_bytes;
    sum.watched_s += thread.watched_s;
    append(sum.snapshot_ms, thread.snapshot_ms);
    add_messages(sum.problems, thread.problems);
    sum.busiest_thread = std::max(sum.busiest_thread, thread.busiest_thread);
  }
  return sum;
}

bool all_got_through(const LoadResult& result) {
  return !result.cameras.empty() &&
         std::all_of(result.cameras.begin(), result.cameras.end(), got_through);
}

}  // namespace hermite::client
