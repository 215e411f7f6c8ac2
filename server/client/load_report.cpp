#include "server/client/load_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/printf_text.h"
#include "server/client/plural.h"

namespace hermite::client {

namespace {

using Json = nlohmann::ordered_json;

// From these shares on the numbers say more about the load test than about the server. The first is
// where two threads that want to run begin to wait for each other noticeably.
constexpr double kMuchOfTheMachine = 0.7;
constexpr double kMuchOfAThread = 0.8;
constexpr double kOfferedInTime = 0.95;

double as_double(std::uint64_t count) { return static_cast<double>(count); }

std::string bytes_text(double bytes) {
  if (bytes < 1e3) return printf_text("%.0f bytes", bytes);
  if (bytes < 1e6) return printf_text("%.1f kB", bytes / 1e3);
  if (bytes < 1e9) return printf_text("%.1f MB", bytes / 1e6);
  return printf_text("%.2f GB", bytes / 1e9);
}

// "45 ms", "-" if there is none.
std::string ms_text(const TimeSummary& times, double ms) {
  return times.count == 0 ? "-" : printf_text("%.0f ms", ms);
}

std::string row(const std::string& name, const CameraLoad& camera) {
  const TimeSummary times = summary_of(camera.answer_ms);
  const std::string tracked =
      camera.answered == 0 ? "-" : printf_text("%.1f %%", 100 * tracked_share(camera));
  return printf_text(
      "%-8s %5llu %8llu %8llu %8llu %8llu %8llu %8llu %10.1f %% %9s %9s %9s %9s %9s\n",
      name.c_str(), static_cast<unsigned long long>(camera.scans_finished),
      static_cast<unsigned long long>(camera.offered), static_cast<unsigned long long>(camera.sent),
      static_cast<unsigned long long>(camera.answered),
      static_cast<unsigned long long>(camera.client_dropped),
      static_cast<unsigned long long>(camera.server_dropped),
      static_cast<unsigned long long>(camera.left_out), 100 * unanswered_share(camera),
      tracked.c_str(), ms_text(times, times.median).c_str(), ms_text(times, times.p95).c_str(),
      ms_text(times, times.p99).c_str(), ms_text(times, times.largest).c_str());
}

// Indices of the cameras to show, in their order.
std::vector<std::size_t> shown_cameras(const std::vector<CameraLoad>& cameras) {
  std::vector<std::pair<double, std::size_t>> slowest;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    slowest.emplace_back(-summary_of(cameras[i].answer_ms).p95, i);
  std::sort(slowest.begin(), slowest.end());
  slowest.resize(std::min(slowest.size(), kMaxLoadRows));
  std::vector<std::size_t> shown;
  for (const auto& [p95, index] : slowest) shown.push_back(index);
  std::sort(shown.begin(), shown.end());
  return shown;
}

std::string table(const LoadResult& result, const CameraLoad& all) {
  std::string text =
      printf_text("%-8s %5s %8s %8s %8s %8s %8s %8s %12s %9s %9s %9s %9s %9s\n", "", "", "", "", "",
                  "client", "server", "left", "without", "", "answer", "", "", "");
  text += printf_text("%-8s %5s %8s %8s %8s %8s %8s %8s %12s %9s %9s %9s %9s %9s\n", "camera",
                      "scans", "frames", "sent", "answered", "drops", "drops", "out", "answer",
                      "tracked", "median", "p95", "p99", "largest");
  const std::vector<std::size_t> shown = shown_cameras(result.cameras);
  for (const std::size_t index : shown)
    text += row(std::to_string(index + 1), result.cameras[index]);
  text += row("all", all);
  if (shown.size() < result.cameras.size())
    text += fmt::format("(the {} cameras of {} with the longest p95; --json has all)\n",
                        shown.size(), result.cameras.size());
  return text;
}

std::string line(const char* name, const std::string& text) {
  return printf_text("%-9s", name) + text + "\n";
}

std::string waiting_text(const LoadResult& result, const CameraLoad& all) {
  const auto waited = std::count_if(result.cameras.begin(), result.cameras.end(),
                                    [](const CameraLoad& one) { return !one.wait_s.empty(); });
  const auto without = std::count_if(result.cameras.begin(), result.cameras.end(),
                                     [](const CameraLoad& one) { return one.without_place; });
  if (waited == 0) return "no camera had to wait for a place";
  const TimeSummary waits = summary_of(all.wait_s);
  std::string text = fmt::format(
      "{} had to wait for a place, {}", plural(static_cast<std::uint64_t>(waited), "camera"),
      printf_text("%.1f s (median), %.1f s at most", waits.median, waits.largest));
  if (without > 0) text += fmt::format("; {} still waited at the end", without);
  return text;
}

std::string viewers_text(const LoadResult& result) {
  const ViewerLoad& viewers = result.viewers;
  const double each_s = std::max(viewers.watched_s, 1e-3);
  std::string text = fmt::format(
      "{} watched, for {}{}/s and {}{} refused, {} disconnected\n", plural(viewers.watched, "scan"),
      printf_text("%.0f s together; ", viewers.watched_s),
      bytes_text(as_double(viewers.received_bytes) / each_s),
      printf_text("%.1f messages/s for each viewer; ", as_double(viewers.messages) / each_s),
      viewers.refused, viewers.disconnected);
  const TimeSummary snapshots = summary_of(viewers.snapshot_ms);
  if (snapshots.count == 0) return text + "         none got the whole snapshot";
  return fmt::format("{}         the whole snapshot after {}", text,
                     printf_text("%.0f ms (median), %.0f ms (p95), %.0f ms at most",
                                 snapshots.median, snapshots.p95, snapshots.largest));
}

std::string bytes_line(const LoadResult& result, const CameraLoad& all) {
  const double seconds = std::max(result.seconds, 1e-3);
  const double up = as_double(all.sent_bytes + result.viewers.sent_bytes),
               down = as_double(result.viewers.received_bytes);
  return fmt::format(
      "{} up ({}/s), {} down to viewers ({}/s); the short answers to cameras are not counted",
      bytes_text(up), bytes_text(up / seconds), bytes_text(down), bytes_text(down / seconds));
}

std::string messages_text(const char* name, const MessageCounts& counts) {
  std::string text;
  for (const auto& [message, times] : counts)
    text += line(name, fmt::format("{} x {}", times, message));
  return text;
}

std::string cleaning_text(const LoadCleaning& cleaning) {
  std::string text = fmt::format("{} deleted", cleaning.deleted);
  if (!cleaning.left.empty())
    text += fmt::format(", {} left on the server with the tag \"load test\": {}",
                        cleaning.left.size(), cleaning.why_left);
  return text;
}

Json json_of(const TimeSummary& times) {
  return {{"count", times.count},
          {"median", times.median},
          {"p95", times.p95},
          {"p99", times.p99},
          {"largest", times.largest}};
}

Json json_of(const CameraLoad& camera) {
  return {{"scans_begun", camera.scans_begun},
          {"scans_finished", camera.scans_finished},
          {"scans_failed", camera.scans_failed},
          {"refused", camera.refused},
          {"frames_due", camera.due},
          {"frames_offered", camera.offered},
          {"sent", camera.sent},
          {"answered", camera.answered},
          {"dropped_by_client", camera.client_dropped},
          {"dropped_by_server", camera.server_dropped},
          {"left_out", camera.left_out},
          {"without_answer_share", unanswered_share(camera)},
          {"tracked_share", tracked_share(camera)},
          {"answer_ms", json_of(summary_of(camera.answer_ms))},
          {"wait_s", json_of(summary_of(camera.wait_s))},
          {"without_place_at_end", camera.without_place},
          {"reconnects", camera.reconnects},
          {"problem_frames", camera.problem_frames},
          {"sent_bytes", camera.sent_bytes},
          {"refusals", camera.refusals},
          {"messages", camera.other}};
}

Json json_of(const ViewerLoad& viewers) {
  return {
      {"watched", viewers.watched},       {"watched_s", viewers.watched_s},
      {"messages", viewers.messages},     {"received_bytes", viewers.received_bytes},
      {"sent_bytes", viewers.sent_bytes}, {"snapshot_ms", json_of(summary_of(viewers.snapshot_ms))},
      {"refused", viewers.refused},       {"disconnected", viewers.disconnected},
      {"problems", viewers.problems}};
}

}  // namespace

std::vector<std::string> load_notes(const LoadResult& result) {
  const CameraLoad all = sum_of(result.cameras);
  const LoadMachine& machine = result.machine;
  std::vector<std::string> notes;
  if (result.interrupted) notes.push_back("The test was interrupted before its time was over.");
  if (as_double(all.offered) < kOfferedInTime * as_double(all.due))
    notes.push_back(
        printf_text("The load test had only %.0f %% of the frames in time: the numbers are those "
                    "of a lighter load.",
                    100 * as_double(all.offered) / as_double(all.due)));
  if (machine.cores_used > kMuchOfTheMachine * machine.cores)
    notes.push_back(
        printf_text("The load test itself used %.1f of %d cores: the numbers are limited by it.",
                    machine.cores_used, machine.cores));
  if (result.viewers.busiest_thread > kMuchOfAThread)
    notes.push_back(
        "A thread with viewers was busy nearly all the time: what they received is limited by the "
        "load test.");
  if (machine.has_server_too)
    notes.push_back(
        "Client and server are on one machine, or a tunnel ends here: they may share its cores, "
        "and the network is not measured.");
  if (all.left_out > 0)
    notes.push_back(
        "Cameras have adapted to a slow link or server: they left out frames and sent colour of "
        "lower quality.");
  if (all.answer_ms.size() < all.answered)
    notes.push_back(plural(all.answered - all.answer_ms.size(), "answer") +
                    " could not be timed, as after a lost connection.");
  return notes;
}

std::string format_load_report(const LoadResult& result) {
  const CameraLoad all = sum_of(result.cameras);
  std::string text =
      fmt::format("{} and {}{}", plural(static_cast<std::uint64_t>(result.camera_count), "camera"),
                  plural(static_cast<std::uint64_t>(result.viewer_count), "viewer"),
                  printf_text(" for %.1f s, live at %.1f frames per second\n\n", result.seconds,
                              result.rate_hz));
  text += table(result, all);
  text +=
      "An answer's time is from sending a frame to its result. A frame without an answer has no "
      "time: the more there are, the less the\n"
      "percentiles say.\n\n";
  text += line("waiting", waiting_text(result, all));
  text +=
      line("links", fmt::format("{}; {} to begin a scan refused, {} failed",
                                plural(all.reconnects, "reconnect"), plural(all.refused, "attempt"),
                                plural(all.scans_failed, "scan")));
  if (result.viewer_count > 0) text += line("viewers", viewers_text(result));
  text += line("bytes", bytes_line(result, all));
  text += line("client", printf_text("used %.2f of %d cores", result.machine.cores_used,
                                     result.machine.cores));
  text += line("scans", cleaning_text(result.cleaning));
  text += messages_text("refused", all.refusals) + messages_text("camera", all.other) +
          messages_text("viewer", result.viewers.problems);
  for (const std::string& note : load_notes(result)) text += line("note", note);
  const auto through = static_cast<std::uint64_t>(
      std::count_if(result.cameras.begin(), result.cameras.end(), got_through));
  text += line("result", all_got_through(result)
                             ? std::string("every camera got through")
                             : fmt::format("{} of {} got through", through,
                                           plural(result.cameras.size(), "camera")));
  return text;
}

std::string load_report_json(const LoadResult& result) {
  Json each = Json::array();
  for (const CameraLoad& camera : result.cameras) each.push_back(json_of(camera));
  const LoadMachine& machine = result.machine;
  const Json json{{"every_camera_got_through", all_got_through(result)},
                  {"cameras", result.camera_count},
                  {"viewers", result.viewer_count},
                  {"rate_hz", result.rate_hz},
                  {"seconds", result.seconds},
                  {"interrupted", result.interrupted},
                  {"all_cameras", json_of(sum_of(result.cameras))},
                  {"each_camera", each},
                  {"all_viewers", json_of(result.viewers)},
                  {"load_test",
                   {{"cores", machine.cores},
                    {"cores_used", machine.cores_used},
                    {"busiest_viewer_thread", result.viewers.busiest_thread},
                    {"on_the_machine_of_the_server", machine.has_server_too}}},
                  {"scans",
                   {{"deleted", result.cleaning.deleted},
                    {"left", result.cleaning.left},
                    {"why_left", result.cleaning.why_left}}},
                  {"notes", load_notes(result)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace hermite::client
