#include "server/client/upload.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <thread>

#include "core/archive/fresh_folder.h"
#include "core/archive/tar_stream.h"
#include "core/dataset/text_file.h"
#include "core/digest/sha256.h"
#include "server/client/backoff.h"
#include "server/client/json_call.h"
#include "server/net/base64.h"

namespace hermite::client {

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kUploads = "/api/v1/uploads";
constexpr const char* kJobs = "/api/v1/jobs";
constexpr int kMaxBadPieces = 5;  // consecutive pieces with a checksum mismatch
constexpr std::chrono::milliseconds kJobPeriod(1000);

Result<std::string> read_part(int descriptor, const std::string& path, std::int64_t offset,
                              std::int64_t count) {
  std::string bytes(static_cast<std::size_t>(count), '\0');
  for (std::int64_t got = 0; got < count;) {
    const ssize_t more =
        pread(descriptor, bytes.data() + got, static_cast<std::size_t>(count - got), offset + got);
    if (more < 0 && errno == EINTR) continue;
    if (more < 0)
      return Error{ErrorCode::kIo, fmt::format("reading {}: {}", path, std::strerror(errno))};
    if (more == 0) return Error{ErrorCode::kIo, path + " has become shorter"};
    got += more;
  }
  return bytes;
}

Result<ByteSource> open_file(const std::string& path) {
  const auto file = std::make_shared<archive::OpenFile>(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file->descriptor() < 0 || fstat(file->descriptor(), &status) != 0)
    return Error{errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                 fmt::format("opening {}: {}", path, std::strerror(errno))};
  if (!S_ISREG(status.st_mode))
    return Error{ErrorCode::kInvalidArgument, path + " is neither a file nor a folder"};
  const std::int64_t size_bytes = status.st_size;
  const std::string fingerprint =
      fmt::format("{} {}.{} {}", size_bytes, status.st_mtim.tv_sec, status.st_mtim.tv_nsec,
                  fs::path(path).filename().string());
  return ByteSource{size_bytes, fingerprint,
                    [file, path, size_bytes](std::int64_t offset, std::int64_t count) {
                      return read_part(file->descriptor(), path, offset,
                                       std::clamp<std::int64_t>(count, 0, size_bytes - offset));
                    }};
}

// One upload.
class Sender {
 public:
  Sender(const ByteSource& source, const UploadMetadata& metadata, const UploadTarget& target,
         const UploadObserver& observer)
      : source_(source), target_(target), observer_(observer), backoff_(std::random_device{}()) {
    for (const auto& [key, value] : metadata)
      metadata_ += (metadata_.empty() ? "" : ",") + key + " " + server::encode_base64(value);
    const std::string known_by =
        fmt::format("{}\n{}\n{}", target_.server.host_and_port(), metadata_, source_.fingerprint);
    if (!target_.notes_folder.empty())
      note_path_ = target_.notes_folder + "/" + digest::sha256_hex(known_by);
  }

  Result<std::string> run() {
    take_up_old();
    for (;;) {
      const Result<bool> complete = location_.empty() ? create()
                                    : offset_         ? send_piece()
                                                      : ask_offset();
      if (complete.ok() && *complete) {
        forget();
        return location_.substr(location_.rfind('/') + 1);
      }
      if (observer_.interrupted && observer_.interrupted())
        return Error{ErrorCode::kIo, "interrupted; the same command goes on with it"};
      if (complete.ok()) continue;
      if (Status waited = wait_after(complete.error()); !waited.ok()) return waited.error();
    }
  }

 private:
  Result<HttpReply> call(const std::string& method, const std::string& path,
                         std::vector<std::pair<std::string, std::string>> headers,
                         std::string body) const {
    headers.emplace_back("Tus-Resumable", "1.0.0");
    return http_exchange(target_.server, target_.tls, true,
                         {method, path, std::move(headers), std::move(body)});
  }

  // Returns false while there is more to do. With `fatal_` an error is final.
  Result<bool> create() {
    const Result<HttpReply> reply = call(
        "POST", kUploads,
        {{"Upload-Length", std::to_string(source_.size_bytes)}, {"Upload-Metadata", metadata_}},
        "");
    if (!reply.ok()) return reply.error();
    if (reply->status != 201) return refused(*reply);
    const std::string location = reply->field("Location").value_or("");
    if (location.rfind(std::string(kUploads) + "/", 0) != 0)
      return final({ErrorCode::kIo, "the server gives an upload no address"});
    location_ = location;
    offset_ = 0;
    got_on();
    if (const Status kept = keep(); !kept.ok() && observer_.on_link)
      observer_.on_link(kept.error().message);
    return false;
  }

  Result<bool> ask_offset() {
    const Result<HttpReply> reply = call("HEAD", location_, {}, "");
    if (!reply.ok()) return reply.error();
    if (reply->status == 404 || reply->status == 410) {
      // It has expired, or the stored address is from an earlier data folder of the server.
      location_.clear();
      return false;
    }
    if (reply->status != 200) return refused(*reply);
    const Result<std::int64_t> offset = offset_in(*reply);
    if (!offset.ok()) return final(offset.error());
    offset_ = *offset;
    got_on();
    if (*offset > 0 && observer_.on_link)
      observer_.on_link(fmt::format("going on at {} MB", *offset / 1'000'000));
    return false;
  }

  // Sends an empty piece if nothing is left, which makes the server check again whether the upload
  // is complete.
  Result<bool> send_piece() {
    Result<std::string> piece =
        source_.read(*offset_, std::min(target_.piece_bytes, source_.size_bytes - *offset_));
    if (!piece.ok()) return final(piece.error());
    const std::string checksum = "sha256 " + server::encode_base64(digest::sha256(*piece));
    const Result<HttpReply> reply = call("PATCH", location_,
                                         {{"Upload-Offset", std::to_string(*offset_)},
                                          {"Content-Type", "application/offset+octet-stream"},
                                          {"Upload-Checksum", checksum}},
                                         *std::move(piece));
    const std::int64_t sent_from = *offset_;
    offset_.reset();  // whatever went wrong, the server knows how much it has
    if (!reply.ok()) return reply.error();
    if (reply->status == 409 || (reply->status == 460 && ++bad_pieces_ < kMaxBadPieces))
      return false;
    if (reply->status != 204) return refused(*reply);
    const Result<std::int64_t> offset = offset_in(*reply);
    if (!offset.ok() || *offset < sent_from)
      return final({ErrorCode::kIo, "the server says that it has less than before"});
    offset_ = *offset;
    bad_pieces_ = 0;
    got_on();
    if (observer_.on_progress) observer_.on_progress(*offset, source_.size_bytes);
    return *offset == source_.size_bytes;
  }

  Result<std::int64_t> offset_in(const HttpReply& reply) const {
    const std::string text = reply.field("Upload-Offset").value_or("");
    std::int64_t offset = -1;
    std::from_chars(text.data(), text.data() + text.size(), offset);
    if (offset < 0 || offset > source_.size_bytes)
      return Error{ErrorCode::kIo, "the server tells no Upload-Offset that could be"};
    return offset;
  }

  Error final(const Error& error) {
    fatal_ = true;
    return error;
  }

  Error refused(const HttpReply& reply) {
    const Error error = refusal(reply);
    fatal_ = error.code != ErrorCode::kBusy && error.code != ErrorCode::kIo;
    return error;
  }

  void got_on() {
    if (std::exchange(away_since_, std::nullopt) && observer_.on_link)
      observer_.on_link("connected again");
    backoff_ = Backoff(std::random_device{}());
  }

  // Waits until it may be tried again; an error if retrying makes no sense.
  Status wait_after(const Error& error) {
    if (fatal_) return error;
    const auto now = Clock::now();
    if (!away_since_ && observer_.on_link) observer_.on_link(error.message + "; trying again");
    if (!away_since_) away_since_ = now;
    if (now - *away_since_ >= target_.patience) return in_context("given up", error);
    const auto until = now + backoff_.next();
    while (Clock::now() < until) {
      if (observer_.interrupted && observer_.interrupted())
        return Error{ErrorCode::kIo, "interrupted; the same command goes on with it"};
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return Done{};
  }

  void take_up_old() {
    if (note_path_.empty()) return;
    Result<std::string> note = dataset::read_text_file(note_path_, 256);
    if (note.ok() && note->rfind(std::string(kUploads) + "/", 0) == 0)
      location_ = note->substr(0, note->find('\n'));
  }

  // Succeeds even if the address cannot be stored; then another run starts again.
  Status keep() const {
    if (note_path_.empty()) return Done{};
    std::error_code error;
    fs::create_directories(target_.notes_folder, error);
    const archive::OpenFile file(
        ::open(note_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    const std::string line = location_ + "\n";
    if (file.descriptor() < 0)
      return Error{ErrorCode::kIo,
                   "keeping a note of the upload: " + std::string(std::strerror(errno))};
    return file.write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  }

  void forget() const {
    if (!note_path_.empty()) unlink(note_path_.c_str());
  }

  const ByteSource& source_;
  const UploadTarget& target_;
  const UploadObserver& observer_;
  std::string metadata_;
  std::string note_path_;
  std::string location_;                // empty: not created yet
  std::optional<std::int64_t> offset_;  // how much the server has; std::nullopt: it has to be asked
  int bad_pieces_ = 0;
  bool fatal_ = false;
  std::optional<Clock::time_point> away_since_;
  Backoff backoff_;
};

JobReport report_of(const Json& json) {
  return {text_member(json, "id"),      text_member(json, "title"),   text_member(json, "state"),
          text_member(json, "stage"),   text_member(json, "words"),   text_member(json, "scan"),
          integer_member(json, "done"), integer_member(json, "total")};
}

Result<Json> ask(const UploadTarget& target, const std::string& method, const std::string& path) {
  return json_call(target.server, target.tls, {method, path, {}, ""});
}

Result<JobReport> one_report(const Result<Json>& json) {
  if (!json.ok()) return json.error();
  return report_of(*json);
}

}  // namespace

Result<ByteSource> open_bytes(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return open_file(path);
  Result<archive::TarStream> opened = archive::TarStream::open(path);
  if (!opened.ok()) return opened.error();
  const auto tar = std::make_shared<const archive::TarStream>(*std::move(opened));
  return ByteSource{
      tar->size_bytes(), tar->fingerprint(),
      [tar](std::int64_t offset, std::int64_t count) { return tar->read(offset, count); }};
}

Result<std::string> upload(const ByteSource& source, const UploadMetadata& metadata,
                           const UploadTarget& target, const UploadObserver& observer) {
  return Sender(source, metadata, target, observer).run();
}

Result<JobReport> job_report(const UploadTarget& target, const std::string& id) {
  return one_report(ask(target, "GET", std::string(kJobs) + "/" + id));
}

Result<std::vector<JobReport>> job_reports(const UploadTarget& target) {
  const Result<Json> json = ask(target, "GET", kJobs);
  if (!json.ok()) return json.error();
  std::vector<JobReport> reports;
  for (const Json& job : json->value("jobs", Json::array()))
    if (job.is_object()) reports.push_back(report_of(job));
  return reports;
}

Result<JobReport> change_job(const UploadTarget& target, const std::string& id, bool retry) {
  return one_report(ask(target, retry ? "POST" : "DELETE",
                        std::string(kJobs) + "/" + id + (retry ? "/retry" : "")));
}

Result<JobReport> wait_for_job(const UploadTarget& target, const std::string& id,
                               const std::function<bool(const JobReport&)>& go_on) {
  Clock::time_point heard_at = Clock::now();
  for (;;) {
    Result<JobReport> report = job_report(target, id);
    const bool passing = !report.ok() && (report.error().code == ErrorCode::kIo ||
                                          report.error().code == ErrorCode::kBusy);
    if (!report.ok() && (!passing || Clock::now() - heard_at >= target.patience)) return report;
    if (report.ok()) heard_at = Clock::now();
    if (report.ok() && report->ended()) return report;
    if (!go_on(report.ok() ? *report : JobReport{}))
      return Error{ErrorCode::kIo, "interrupted; the job goes on"};
    std::this_thread::sleep_for(kJobPeriod);
  }
}

}  // namespace hermite::client
