#include "server/client/download.h"

#include <fmt/core.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "server/client/json_call.h"

namespace hermite::client {

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kPollPeriod(500), kAwayPause(2000);

std::string exports_path(const DownloadTarget& target) {
  return fmt::format("/api/v1/scans/{}/exports", target.scan_id);
}

ExportReport report_of(const Json& json) {
  ExportReport report;
  report.format = text_member(json, "format");
  report.label = text_member(json, "label");
  report.file = text_member(json, "file");
  report.state = text_member(json, "state");
  report.message = text_member(json, "words");
  if (json.contains("done") && json["done"].is_number()) report.done = json["done"].get<double>();
  if (json.contains("bytes") && json["bytes"].is_number_unsigned())
    report.size_bytes = json["bytes"].get<std::uint64_t>();
  return report;
}

// One download. Repeats requests while the server is unreachable or busy, for as long as
// `patience`.
class Downloading {
 public:
  Downloading(const DownloadTarget& target, const DownloadObserver& observer)
      : target_(target), observer_(observer) {}

  Status make() {
    const Result<HttpReply> reply = ask({"POST",
                                         exports_path(target_),
                                         {{"Content-Type", "application/json"}},
                                         Json{{"format", target_.format}}.dump()});
    if (!reply.ok()) return reply.error();
    const Json json = Json::parse(reply->body, nullptr, false);
    if (!json.is_object()) return Error{ErrorCode::kIo, "the server's answer cannot be read"};
    return json.value("state", "") == "ready" ? Status(Done{}) : wait();
  }

  // Downloads the version to which the first piece belongs; if the version changes, starts again.
  Status take(std::ofstream& file) {
    std::uint64_t come_bytes = 0, total_bytes = 1;
    std::string version;
    while (come_bytes < total_bytes) {
      const std::uint64_t last = come_bytes + target_.piece_bytes - 1;
      HttpCall call{"GET", exports_path(target_) + "/" + target_.format, {}, {}};
      call.headers.emplace_back("Range", fmt::format("bytes={}-{}", come_bytes, last));
      if (!version.empty()) call.headers.emplace_back("If-Range", version);
      const Result<HttpReply> piece = ask(call);
      if (!piece.ok()) return piece.error();
      const std::optional<std::string> range = piece->field("Content-Range");
      if (piece->status != 206 || !range)
        return Error{ErrorCode::kIo, "the file has changed on the server meanwhile: try again"};
      const std::size_t slash = range->find('/');
      const char* const end = range->data() + range->size();
      if (slash == std::string::npos ||
          std::from_chars(range->data() + slash + 1, end, total_bytes).ptr != end ||
          piece->body.empty())
        return Error{ErrorCode::kIo, "the server's answer has the Content-Range " + *range};
      version = piece->field("ETag").value_or("");
      file.write(piece->body.data(), static_cast<std::streamsize>(piece->body.size()));
      if (!file) return Error{ErrorCode::kIo, "the file cannot be written"};
      come_bytes += piece->body.size();
      if (observer_.on_progress) observer_.on_progress(come_bytes, total_bytes);
    }
    return Done{};
  }

  Result<HttpReply> ask(const HttpCall& call) {
    const Clock::time_point give_up = Clock::now() + target_.patience;
    for (;;) {
      Result<HttpReply> reply = http_exchange(target_.server, target_.tls, true, call);
      if (reply.ok() && reply->status < 300) return reply;
      const bool busy = reply.ok() && (reply->status == 429 || reply->status == 503);
      const Error why = reply.ok() ? refusal(*reply) : reply.error();
      if ((reply.ok() && !busy) || Clock::now() >= give_up || is_interrupted()) return why;
      std::this_thread::sleep_for(kAwayPause);
    }
  }

 private:
  bool is_interrupted() const { return observer_.interrupted && observer_.interrupted(); }

  // Waits until the export is no longer queued or running; succeeds if it is ready.
  Status wait() {
    for (;;) {
      if (is_interrupted()) return Error{ErrorCode::kIo, "interrupted"};
      std::this_thread::sleep_for(kPollPeriod);
      const Result<HttpReply> reply = ask({"GET", exports_path(target_), {}, {}});
      if (!reply.ok()) return reply.error();
      const Json json = Json::parse(reply->body, nullptr, false);
      ExportReport report;
      for (const Json& one :
           json.is_object() && json.contains("exports") ? json["exports"] : Json::array())
        if (one.is_object() && one.value("format", "") == target_.format) report = report_of(one);
      if (report.state == "ready") return Done{};
      if (report.state != "queued" && report.state != "running")
        return Error{ErrorCode::kIo,
                     fmt::format("{} was not made: {}", target_.format,
                                 report.message.empty() ? "it was stopped" : report.message)};
      if (observer_.on_state) observer_.on_state(report);
    }
  }

  const DownloadTarget& target_;
  const DownloadObserver& observer_;
};

}  // namespace

Result<std::vector<ExportReport>> export_reports(const DownloadTarget& target) {
  const DownloadObserver nobody;
  const Result<HttpReply> reply =
      Downloading(target, nobody).ask({"GET", exports_path(target), {}, {}});
  if (!reply.ok()) return reply.error();
  const Json json = Json::parse(reply->body, nullptr, false);
  if (!json.is_object() || !json.contains("exports") || !json["exports"].is_array())
    return Error{ErrorCode::kIo, "the server's list of exports cannot be read"};
  std::vector<ExportReport> reports;
  for (const Json& one : json["exports"])
    if (one.is_object()) reports.push_back(report_of(one));
  return reports;
}

Status download(const DownloadTarget& target, const std::string& path,
                const DownloadObserver& observer) {
  Downloading downloading(target, observer);
  if (Status made = downloading.make(); !made.ok()) return made;
  const std::string unfinished = path + ".partial";
  std::error_code error;
  Status taken = Done{};
  {
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    taken =
        file ? downloading.take(file) : Status(Error{ErrorCode::kIo, "cannot write " + unfinished});
    file.close();
    if (taken.ok() && !file) taken = Error{ErrorCode::kIo, "cannot write " + unfinished};
  }
  if (taken.ok()) std::filesystem::rename(unfinished, path, error);
  if (error)
    taken = Error{ErrorCode::kIo, fmt::format("renaming {}: {}", unfinished, error.message())};
  if (!taken.ok()) std::filesystem::remove(unfinished, error);
  return taken;
}

}  // namespace hermite::client
