#include "server/uploads/uploads.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "server/store/disk_space.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

constexpr std::size_t kMaxWholeOnes = 1000;  // limit on remembered complete uploads

std::string megabytes(std::int64_t bytes) { return fmt::format("{} MB", bytes / 1'000'000); }

Error no_upload() { return {ErrorCode::kNotFound, "there is no such upload; it may have expired"}; }

// Returns the size with which an upload counts: the announced length or, if larger, what was
// received.
std::int64_t claimed_bytes(const UploadRow& row, std::int64_t size_bytes) {
  return std::max(row.length_bytes, size_bytes);
}

}  // namespace

Uploads::Uploads(UploadLimits limits, const Storage& storage,
                 std::function<Status(const UploadRow&)> complete)
    : limits_(limits),
      storage_(storage),
      data_(storage.data),
      store_(storage.store),
      complete_(std::move(complete)) {
  const Result<std::vector<UploadRow>> rows = store_.uploads.list();
  if (!rows.ok()) throw SetupError(rows.error());
  for (const UploadRow& row : *rows) {
    const Result<std::int64_t> size_bytes = recover(row);
    if (!size_bytes.ok()) spdlog::warn("upload {}: {}", row.id, size_bytes.error().message);
    if (!size_bytes.ok() && size_bytes.error().code == ErrorCode::kNotFound) forget(row.id);
    if (!size_bytes.ok() || *size_bytes != row.length_bytes) continue;
    if (const Status told = complete_(row); !told.ok())
      spdlog::warn("upload {}: {}", row.id, told.error().message);
  }
}

// After a start: makes the contents of the file durable before anything is reported of it.
Result<std::int64_t> Uploads::recover(UploadRow row) {
  Result<UploadFile> file = UploadFile::open(data_.upload_path(row.id));
  if (!file.ok()) return file.error();
  const bool unchecked = row.unchecked_from >= 0;
  if (unchecked && row.unchecked_from < file->size_bytes())
    if (Status status = file->cut(row.unchecked_from); !status.ok()) return status.error();
  if (Status status = file->sync(); !status.ok()) return status.error();
  row.unchecked_from = -1;
  if (unchecked)
    if (Status status = store_.uploads.update(row); !status.ok()) return status.error();
  return file->size_bytes();
}

std::int64_t Uploads::size_of(const std::string& id) const {
  const Result<std::int64_t> size_bytes = upload_size_bytes(data_.upload_path(id));
  return size_bytes.ok() ? *size_bytes : 0;
}

Status Uploads::check_room(std::int64_t more_bytes, const std::string& except_id,
                           const Grant& grant) {
  const Result<std::uint64_t> free = free_bytes(data_.path());
  if (!free.ok()) return free.error();
  if (*free < limits_.min_free_disk_bytes + static_cast<std::uint64_t>(more_bytes))
    return Error{ErrorCode::kBusy, fmt::format("the server's disk has not enough room: {} are free",
                                               megabytes(static_cast<std::int64_t>(*free)))};
  const Result<std::vector<UploadRow>> rows = store_.uploads.list();
  if (!rows.ok()) return rows.error();
  if (Status status = check_storage(more_bytes, except_id, *rows, grant); !status.ok())
    return status;
  if (limits_.token_bytes == 0 || may(grant, Scope::kAdmin)) return Done{};
  std::int64_t held_bytes = 0;
  for (const UploadRow& row : *rows)
    if (row.token_id == grant.token_id && row.id != except_id)
      held_bytes += claimed_bytes(row, size_of(row.id));
  if (held_bytes + more_bytes <= limits_.token_bytes) return Done{};
  return Error{ErrorCode::kBusy,
               fmt::format("the uploads of this token take {} of the {} that they may take: wait "
                           "until their jobs have ended, or delete some",
                           megabytes(held_bytes), megabytes(limits_.token_bytes))};
}

// Counts existing files, and what other uploads were promised and have not sent yet.
Status Uploads::check_storage(std::int64_t more_bytes, const std::string& except_id,
                              const std::vector<UploadRow>& rows, const Grant& grant) const {
  if (!storage_.quota.has_limit()) return Done{};
  Result<std::vector<std::string>> own_scans = store_.scans.of_token(grant.token_id);
  if (!own_scans.ok()) return own_scans.error();
  StorageAsker asker{may(grant, Scope::kAdmin), *std::move(own_scans), 0};
  std::uint64_t held_bytes = 0;
  for (const UploadRow& row : rows) {
    if (row.id == except_id) continue;
    const auto claimed = static_cast<std::uint64_t>(claimed_bytes(row, size_of(row.id)));
    held_bytes += claimed;
    if (row.token_id == grant.token_id) asker.upload_bytes += claimed;
  }
  return storage_.quota.check(held_bytes, static_cast<std::uint64_t>(more_bytes), asker);
}

Result<UploadState> Uploads::create(std::int64_t length_bytes, const std::string& metadata,
                                    const Grant& grant, std::int64_t now_ms) {
  UploadState state{
      {new_scan_id(), grant.token_id, -1, metadata, -1, now_ms, now_ms + limits_.keep_ms}, 0};
  if (length_bytes >= 0) {
    if (length_bytes > limits_.upload_bytes)
      return Error{ErrorCode::kTooLarge, fmt::format("Upload-Length is {}, allowed are {} bytes",
                                                     length_bytes, limits_.upload_bytes)};
    if (length_bytes == 0)
      return Error{ErrorCode::kInvalidArgument, "Upload-Length is 0: nothing can be made of it"};
    if (Status status = check_room(length_bytes, "", grant); !status.ok()) return status.error();
    state.row.length_bytes = length_bytes;
  }
  // A file without a row is moved away at the next start (orphans.h); a row without a file would be
  // a false promise.
  const Result<UploadFile> file = UploadFile::create(data_.upload_path(state.row.id));
  if (!file.ok()) return file.error();
  if (Status status = store_.uploads.add(state.row); !status.ok()) {
    if (Status removed = remove_upload_file(data_.upload_path(state.row.id)); !removed.ok())
      spdlog::warn("{}", removed.error().message);
    return status.error();
  }
  return state;
}

Result<UploadState> Uploads::find(const std::string& id, const Grant& grant, std::int64_t now_ms) {
  if (!is_scan_id(id)) return no_upload();
  Result<UploadRow> row = store_.uploads.find(id);
  if (!row.ok()) return row.error().code == ErrorCode::kNotFound ? no_upload() : row.error();
  if (row->token_id != grant.token_id && !may(grant, Scope::kAdmin)) return no_upload();
  if (row->expires_at_ms <= now_ms && !has_waiting_job(id)) return no_upload();
  const Result<std::int64_t> offset_bytes = upload_size_bytes(data_.upload_path(id));
  if (!offset_bytes.ok()) return offset_bytes.error();
  return UploadState{*std::move(row), *offset_bytes};
}

bool Uploads::is_free(const std::string& id, bool at_once) {
  const auto found = writers_.find(id);
  if (found == writers_.end()) return true;
  if (const std::shared_ptr<UploadWriter> writer = found->second.lock()) {
    if (at_once || writer->is_idle()) writer->give_up();
    return false;
  }
  writers_.erase(found);
  return true;
}

Status Uploads::set_length(UploadState& state, std::int64_t length_bytes, const Grant& grant) {
  if (length_bytes < state.offset_bytes || length_bytes == 0)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("Upload-Length is {}, and {} bytes are here already", length_bytes,
                             state.offset_bytes)};
  if (length_bytes > limits_.upload_bytes)
    return Error{ErrorCode::kTooLarge, fmt::format("Upload-Length is {}, allowed are {} bytes",
                                                   length_bytes, limits_.upload_bytes)};
  if (Status status = check_room(length_bytes, state.row.id, grant); !status.ok()) return status;
  state.row.length_bytes = length_bytes;
  return store_.uploads.update(state.row);
}

Result<std::shared_ptr<UploadWriter>> Uploads::write(const UploadState& state,
                                                     const UploadPiece& piece, const Grant& grant) {
  CHECK(is_free(state.row.id), "an upload has one writer");
  if (piece.offset_bytes != state.offset_bytes)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("Upload-Offset is {}, and {} bytes are here", piece.offset_bytes,
                             state.offset_bytes)};
  const std::int64_t end = piece.offset_bytes + piece.length_bytes;
  const bool known = state.row.length_bytes >= 0;
  if (end > (known ? state.row.length_bytes : limits_.upload_bytes))
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the piece ends at byte {}, the upload {}", end,
                             known ? fmt::format("has {}", state.row.length_bytes)
                                   : fmt::format("may have {}", limits_.upload_bytes))};
  if (!known)
    if (Status status = check_room(end, state.row.id, grant); !status.ok()) return status.error();
  Result<UploadFile> file = UploadFile::open(data_.upload_path(state.row.id));
  if (!file.ok()) return file.error();
  if (piece.checksum) {
    UploadRow row = state.row;
    row.unchecked_from = piece.offset_bytes;
    if (Status status = store_.uploads.update(row); !status.ok()) return status.error();
  }
  UploadDigest before;
  if (auto known_digest = digests_.extract(state.row.id);
      !known_digest.empty() && known_digest.mapped().size_bytes == piece.offset_bytes)
    before = std::move(known_digest.mapped());
  auto writer = std::make_shared<UploadWriter>(
      *std::move(file), piece, std::move(before), [this] { return free_bytes(data_.path()); },
      limits_.min_free_disk_bytes);
  writers_[state.row.id] = writer;
  return writer;
}

Result<UploadState> Uploads::written(const UploadState& state, UploadWriter& writer,
                                     std::int64_t now_ms) {
  UploadState now{state.row, writer.offset_bytes()};
  now.row.unchecked_from = -1;
  now.row.expires_at_ms = now_ms + limits_.keep_ms;
  writers_.erase(now.row.id);
  if (Status status = store_.uploads.update(now.row); !status.ok()) return status.error();
  UploadDigest digest = writer.take_digest();
  if (!now.complete()) {
    if (digest.context) digests_.insert_or_assign(now.row.id, std::move(digest));
    return now;
  }
  now.job_id = twin_of(now.row, std::move(digest), writer.is_whole());
  if (!now.job_id.empty()) {
    forget(now.row.id);
    if (twins_.size() >= kMaxWholeOnes) twins_.clear();
    twins_[now.row.id] = now.job_id;
    return now;
  }
  if (Status status = complete_(now.row); !status.ok()) return status.error();
  return now;
}

std::string Uploads::job_of(const std::string& id) const {
  const auto twin = twins_.find(id);
  return twin == twins_.end() ? id : twin->second;
}

// A client that sends the same file several times at once wants a single job. Remembers the first
// such upload.
std::string Uploads::twin_of(const UploadRow& row, UploadDigest digest, bool is_whole) {
  if (!digest.context) return {};
  unsigned char bytes[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  CHECK(EVP_DigestFinal_ex(digest.context.get(), bytes, &size) == 1, "a digest has an end");
  const std::string content_sha256(reinterpret_cast<const char*>(bytes), size);
  if (whole_ones_.size() >= kMaxWholeOnes) whole_ones_.clear();
  std::string& first =
      whole_ones_[fmt::format("{}\n{}\n{}", row.token_id, row.metadata, content_sha256)];
  const Result<JobRow> job =
      first.empty() ? Error{ErrorCode::kNotFound, ""} : store_.jobs.find(first);
  const bool is_one =
      job.ok() && (!has_ended(job->state) || (is_whole && job->state == JobState::kFinished &&
                                              store_.scans.find(job->scan_id).ok()));
  if (!is_one) first = row.id;
  return is_one ? first : std::string();
}

bool Uploads::is_written(const std::string& id) const {
  const auto writer = writers_.find(id);
  return writer != writers_.end() && !writer->second.expired();
}

bool Uploads::has_waiting_job(const std::string& id) {
  const Result<JobRow> job = store_.jobs.find(id);
  return job.ok() && !has_ended(job->state);
}

Status Uploads::remove(const std::string& id, const Grant& grant, std::int64_t now_ms) {
  if (const Result<UploadState> found = find(id, grant, now_ms); !found.ok()) return found.error();
  if (has_waiting_job(id))
    return Error{ErrorCode::kBusy, "a job works on this upload: cancel that first"};
  digests_.erase(id);
  if (Status status = storage_.waste.remove_upload(id); !status.ok()) return status;
  return store_.uploads.remove(id);
}

Result<std::vector<UploadState>> Uploads::list(const Grant& grant) {
  const Result<std::vector<UploadRow>> rows = store_.uploads.list();
  if (!rows.ok()) return rows.error();
  std::vector<UploadState> states;
  for (const UploadRow& row : *rows)
    if (row.token_id == grant.token_id || may(grant, Scope::kAdmin))
      states.push_back({row, is_written(row.id) ? -1 : size_of(row.id)});
  return states;
}

void Uploads::forget(const std::string& id) {
  digests_.erase(id);
  if (const Status removed = storage_.waste.remove_upload(id); !removed.ok())
    spdlog::warn("{}", removed.error().message);
  const Status removed = store_.uploads.remove(id);
  if (!removed.ok() && removed.error().code != ErrorCode::kNotFound)
    spdlog::warn("{}", removed.error().message);
}

void Uploads::keep(const std::string& id, std::int64_t now_ms) {
  Result<UploadRow> row = store_.uploads.find(id);
  if (!row.ok()) return;
  row->expires_at_ms = now_ms + limits_.keep_ms;
  if (const Status kept = store_.uploads.update(*row); !kept.ok())
    spdlog::warn("upload {}: {}", id, kept.error().message);
}

void Uploads::sweep(std::int64_t now_ms) {
  const Result<std::vector<UploadRow>> rows = store_.uploads.list();
  if (!rows.ok()) return;
  for (const UploadRow& row : *rows) {
    if (row.expires_at_ms > now_ms || has_waiting_job(row.id)) continue;
    if (is_written(row.id)) continue;
    spdlog::info("upload {} has expired", row.id);
    forget(row.id);
  }
}

}  // namespace hermite::server
