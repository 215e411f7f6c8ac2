#include "server/routes/upload_routes.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "server/jobs/job_request.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/store/http_date.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kUploadLocation = "/api/v1/uploads/";
// Jobs take minutes, and release the space of their uploads.
constexpr std::int64_t kRoomRetry_ms = 30'000;

HttpAnswer plain(int status, HttpHeaders headers = {}) {
  HttpAnswer answer;
  answer.status = status;
  answer.headers = std::move(headers);
  return answer;
}

HttpAnswer with_version(HttpAnswer answer) {
  answer.headers.emplace_back("Tus-Resumable", kTusVersion);
  return answer;
}

HttpAnswer refused_upload(const Error& error) {
  if (error.code == ErrorCode::kTooLarge) return error_answer(413, error);
  if (error.code == ErrorCode::kUnsupported) return error_answer(400, error);
  if (error.code == ErrorCode::kBusy) return wait_answer(503, error.message, kRoomRetry_ms);
  if (error.code == ErrorCode::kIo) return error_answer(507, error);
  return refused(error);
}

HttpHeaders offset_headers(const UploadState& state) {
  HttpHeaders headers{{"Upload-Offset", std::to_string(state.offset_bytes)}};
  if (!state.complete()) headers.emplace_back("Upload-Expires", http_date(state.row.expires_at_ms));
  return headers;
}

// Returns the headers of tus; if they violate the protocol, `wrong` is the answer.
Result<TusHeaders> read_headers(const HttpRequest& request, HttpAnswer& wrong) {
  Result<TusHeaders> headers = parse_tus_headers(request.headers);
  if (!headers.ok()) {
    wrong = refused_upload(headers.error());
  } else if (headers->version != kTusVersion) {
    const Error error{ErrorCode::kUnsupported, "Tus-Resumable must be " + std::string(kTusVersion)};
    wrong = error_answer(412, error);
    wrong.headers.emplace_back("Tus-Version", kTusVersion);
    return error;
  }
  return headers;
}

// Receives the body of a request into an upload.
class UploadBody : public BodySink {
 public:
  // Makes the answer once the received bytes are on disk. `received` is an error of the disk or
  // checksum, or why the body is incomplete.
  using Say = std::function<HttpAnswer(const UploadState& state, const Status& received)>;

  UploadBody(const HttpWorld& world, UploadState state, std::shared_ptr<UploadWriter> writer,
             Grant grant, Say say)
      : world_(world),
        state_(std::move(state)),
        writer_(std::move(writer)),
        grant_(std::move(grant)),
        say_(std::move(say)) {}

  Status write(std::string_view piece) override {
    if (written_.ok()) written_ = writer_->write(piece);
    return written_;
  }
  void close(bool complete) override {
    const Status closed = writer_->close(complete && written_.ok());
    if (written_.ok() && !complete)
      written_ =
          Error{ErrorCode::kBusy, "the connection ended, or another request wants this upload"};
    if (!closed.ok()) written_ = closed;
  }
  bool wanted() const override {
    return writer_->wanted() && world_.gate.holds(grant_, unix_now_ms());
  }
  void on_unwanted(std::function<void()> run) override { writer_->on_unwanted(std::move(run)); }
  HttpAnswer answer() override {
    const Result<UploadState> now = world_.uploads.written(state_, *writer_, unix_now_ms());
    if (!now.ok()) return with_version(refused_upload(now.error()));
    return with_version(say_(*now, written_));
  }

 private:
  const HttpWorld& world_;
  const UploadState state_;
  const std::shared_ptr<UploadWriter> writer_;
  const Grant grant_;
  const Say say_;
  Status written_ = Done{};
};

HttpAnswer refused_piece(const Error& error) {
  if (error.code == ErrorCode::kCorruptData) return error_answer(kChecksumMismatch, error);
  return refused_upload(error);
}

// Returns an answer that receives the body first, or why the body is refused.
HttpAnswer receive(const HttpWorld& world, const Call& call, const UploadState& state,
                   const UploadPiece& piece, UploadBody::Say say) {
  Result<std::shared_ptr<UploadWriter>> writer = world.uploads.write(state, piece, call.grant);
  if (!writer.ok()) return with_version(refused_upload(writer.error()));
  HttpAnswer answer;
  answer.body_sink =
      std::make_shared<UploadBody>(world, state, *std::move(writer), call.grant, std::move(say));
  return answer;
}

HttpAnswer with_headers(int status, HttpHeaders headers) {
  HttpAnswer answer = plain(status, std::move(headers));
  return answer;
}

HttpAnswer busy_upload() {
  HttpAnswer answer =
      error_answer(423, {ErrorCode::kBusy, "another request still writes this upload"});
  answer.ask_again = true;
  return answer;
}

}  // namespace

HttpAnswer list_uploads(const HttpWorld& world, const Call& call) {
  const Result<std::vector<UploadState>> uploads = world.uploads.list(call.grant);
  if (!uploads.ok()) return refused(uploads.error());
  Json json = {{"uploads", Json::array()}};
  for (const UploadState& upload : *uploads) {
    Json row = {{"id", upload.row.id}};
    row["offset"] = upload.offset_bytes < 0 ? Json() : Json(upload.offset_bytes);
    row["length"] = upload.row.length_bytes < 0 ? Json() : Json(upload.row.length_bytes);
    const Result<JobRow> job = job_of_upload(upload.row);
    row["title"] = job.ok() ? job->title : "";
    row["created_at"] = time_json(upload.row.created_at_ms);
    row["expires_at"] = time_json(upload.row.expires_at_ms);
    json["uploads"].push_back(std::move(row));
  }
  return made(json_text(json));
}

HttpAnswer describe_uploads(const HttpWorld& world, const Call&) {
  return with_version(
      plain(204, {{"Tus-Version", kTusVersion},
                  {"Tus-Max-Size", std::to_string(world.uploads.limits().upload_bytes)},
                  {"Tus-Extension", kTusExtensions},
                  {"Tus-Checksum-Algorithm", "sha1,sha256"}}));
}

HttpAnswer create_upload(const HttpWorld& world, const Call& call) {
  HttpAnswer wrong;
  const Result<TusHeaders> headers = read_headers(call.request, wrong);
  if (!headers.ok()) return with_version(std::move(wrong));
  const auto refuse = [](const Error& error) { return with_version(refused_upload(error)); };
  const bool has_body = call.request.body_bytes > 0;
  if (!headers->length_bytes && !headers->length_follows)
    return refuse({ErrorCode::kInvalidArgument,
                   "Upload-Length is missing, or Upload-Defer-Length: 1 instead"});
  if (has_body && !headers->is_piece)
    return with_version(
        error_answer(415, {ErrorCode::kUnsupported,
                           "the Content-Type of a piece is " + std::string(kTusContentType)}));
  // Report what is wrong with the job before gigabytes are sent.
  UploadRow row;
  row.metadata = headers->metadata;
  const Result<JobRow> job = job_of_upload(row);
  if (!job.ok()) return refuse(in_context("Upload-Metadata", job.error()));
  if (const Status status = check_priority(*job, may(call.grant, Scope::kAdmin)); !status.ok())
    return with_version(error_answer(403, in_context("Upload-Metadata", status.error())));
  Result<UploadState> state =
      world.uploads.create(headers->length_bytes.value_or(-1), headers->metadata, call.grant,
                           call.request.caller.now_ms);
  if (!state.ok()) return refuse(state.error());
  const std::string location = kUploadLocation + state->row.id;
  const auto say = [&world, location](const UploadState& now, const Status& received) {
    if (!received.ok() && now.offset_bytes == 0) {
      // The client never learns its Location, so it could not resume it.
      world.uploads.forget(now.row.id);
      return refused_piece(received.error());
    }
    HttpHeaders all = offset_headers(now);
    all.emplace_back("Location", location);
    return with_headers(201, std::move(all));
  };
  if (!has_body) return with_version(say(*state, Done{}));
  return receive(world, call, *state,
                 {0, static_cast<std::int64_t>(call.request.body_bytes), headers->checksum}, say);
}

HttpAnswer show_upload(const HttpWorld& world, const Call& call) {
  HttpAnswer wrong;
  if (const Result<TusHeaders> headers = read_headers(call.request, wrong); !headers.ok())
    return with_version(std::move(wrong));
  Result<UploadState> state = world.uploads.find(call.id, call.grant, call.request.caller.now_ms);
  if (!state.ok()) return with_version(refused_upload(state.error()));
  if (!world.uploads.is_free(call.id)) return with_version(busy_upload());
  HttpHeaders headers = offset_headers(*state);
  if (state->row.length_bytes >= 0)
    headers.emplace_back("Upload-Length", std::to_string(state->row.length_bytes));
  else
    headers.emplace_back("Upload-Defer-Length", "1");
  if (!state->row.metadata.empty()) headers.emplace_back("Upload-Metadata", state->row.metadata);
  return with_version(plain(200, std::move(headers)));
}

HttpAnswer continue_upload(const HttpWorld& world, const Call& call) {
  HttpAnswer wrong;
  const Result<TusHeaders> headers = read_headers(call.request, wrong);
  if (!headers.ok()) return with_version(std::move(wrong));
  if (!headers->is_piece)
    return with_version(
        error_answer(415, {ErrorCode::kUnsupported,
                           "the Content-Type of a piece is " + std::string(kTusContentType)}));
  const auto refuse = [](const Error& error) { return with_version(refused_upload(error)); };
  if (!headers->offset_bytes)
    return refuse({ErrorCode::kInvalidArgument, "Upload-Offset is missing"});
  Result<UploadState> state = world.uploads.find(call.id, call.grant, call.request.caller.now_ms);
  if (!state.ok()) return refuse(state.error());
  if (!world.uploads.is_free(call.id)) return with_version(busy_upload());
  if (*headers->offset_bytes != state->offset_bytes) {
    const std::string message = fmt::format("Upload-Offset is {}, and {} bytes are here",
                                            *headers->offset_bytes, state->offset_bytes);
    return with_version(error_answer(409, {ErrorCode::kInvalidArgument, message}));
  }
  if (headers->length_bytes && *headers->length_bytes != state->row.length_bytes) {
    if (state->row.length_bytes >= 0)
      return refuse({ErrorCode::kInvalidArgument,
                     fmt::format("Upload-Length is {}, it was {}", *headers->length_bytes,
                                 state->row.length_bytes)});
    if (Status status = world.uploads.set_length(*state, *headers->length_bytes, call.grant);
        !status.ok())
      return refuse(status.error());
  }
  const UploadPiece piece{state->offset_bytes, static_cast<std::int64_t>(call.request.body_bytes),
                          headers->checksum};
  return receive(world, call, *state, piece, [](const UploadState& now, const Status& received) {
    return received.ok() ? with_headers(204, offset_headers(now)) : refused_piece(received.error());
  });
}

HttpAnswer remove_upload(const HttpWorld& world, const Call& call) {
  HttpAnswer wrong;
  if (const Result<TusHeaders> headers = read_headers(call.request, wrong); !headers.ok())
    return with_version(std::move(wrong));
  if (const Result<UploadState> state =
          world.uploads.find(call.id, call.grant, call.request.caller.now_ms);
      !state.ok())
    return with_version(refused_upload(state.error()));
  if (!world.uploads.is_free(call.id, true)) return with_version(busy_upload());
  if (Status status = world.uploads.remove(call.id, call.grant, call.request.caller.now_ms);
      !status.ok())
    return with_version(refused(status.error()));
  return with_version(plain(204));
}

HttpAnswer put_upload(const HttpWorld& world, const Call& call) {
  if (call.request.body_bytes == 0)
    return with_version(
        error_answer(411, {ErrorCode::kInvalidArgument,
                           "the recording is the body, and Content-Length says how long it is"}));
  const std::string metadata = "filename " + encode_base64(clean_title(decode_percent(call.id)));
  Result<UploadState> state =
      world.uploads.create(static_cast<std::int64_t>(call.request.body_bytes), metadata, call.grant,
                           call.request.caller.now_ms);
  if (!state.ok()) return with_version(refused_upload(state.error()));
  const UploadPiece piece{0, static_cast<std::int64_t>(call.request.body_bytes), std::nullopt,
                          true};
  return receive(
      world, call, *state, piece, [&world](const UploadState& now, const Status& received) {
        if (now.complete() && !now.job_id.empty())
          return made(json_text({{"job", now.job_id}}), 200);
        if (now.complete()) return made(json_text({{"job", now.row.id}}), 201);
        // The client does not know its id, so it could not resume it.
        world.uploads.forget(now.row.id);
        return received.ok() ? error_answer(400, {ErrorCode::kCorruptData, "the body was cut"})
                             : refused_upload(received.error());
      });
}

}  // namespace hermite::server
