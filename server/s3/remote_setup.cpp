#include "server/s3/remote_setup.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "server/store/place_note.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

constexpr const char *kAt = "blobs-at", *kMoving = "blobs-moving";

Result<std::optional<PlaceNote>> read_note(const std::string& data_folder, const char* name) {
  const std::string path = data_folder + "/" + name;
  Result<std::optional<PlaceNote>> note = read_place_note(path);
  if (note.ok() && *note && !parse_s3_location((*note)->address).ok())
    return Error{
        ErrorCode::kCorruptData,
        path + " does not say where the results are: expected s3://BUCKET/PREFIX and an id"};
  return note;
}

Error elsewhere(const std::string& data_folder, const std::string& noted) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("the results of {} are in {}, as its file blobs-at says: give --blobs {}, or "
                      "move them with `hermite migrate`",
                      data_folder, noted, noted)};
}

// Makes or keeps the note with this name, and claims the prefix with its id.
Status claim(const std::string& data_folder, const char* name, S3Blobs& s3) {
  const Result<std::optional<PlaceNote>> noted = read_note(data_folder, name);
  if (!noted.ok()) return noted.error();
  if (*noted && (*noted)->address != s3.address()) return elsewhere(data_folder, (*noted)->address);
  const Result<std::optional<PlaceNote>> moving = read_note(data_folder, kMoving);
  if (!moving.ok()) return moving.error();
  const bool claimed = *moving && (*moving)->address == s3.address();
  const std::string id = *noted ? (*noted)->id : claimed ? (*moving)->id : new_scan_id();
  const Result<std::string> owner = s3.owner();
  if (!owner.ok() && owner.error().code != ErrorCode::kNotFound) return owner.error();
  if (owner.ok() && *owner != id)
    return Error{ErrorCode::kBusy, s3.address() +
                                       " belongs to another folder of data: take another prefix. "
                                       "If that folder is lost, restore its "
                                       "backup, which has the file blobs-at"};
  // The folder's note goes first: without an owner a prefix is free, and a folder without its note
  // would be another one.
  if (!*noted)
    if (Status status = write_place_note(data_folder + "/" + name, {s3.address(), id});
        !status.ok())
      return status;
  return owner.ok() ? Status(Done{}) : s3.set_owner(id);
}

}  // namespace

Result<S3Options> s3_options(const S3Settings& settings) {
  const Result<S3Location> location = parse_s3_location(settings.blobs);
  if (!location.ok()) return in_context("setting blobs", location.error());
  const Result<std::string> endpoint =
      checked_s3_endpoint(settings.endpoint, settings.region, settings.allow_plain);
  if (!endpoint.ok()) return in_context("settings s3-endpoint and s3-region", endpoint.error());
  if (settings.addressing != "path" && settings.addressing != "virtual-host")
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("setting s3-addressing is '{}', allowed is path or virtual-host",
                             settings.addressing)};
  if (!settings.ca_file.empty() && access(settings.ca_file.c_str(), R_OK) != 0)
    return Error{ErrorCode::kNotFound,
                 fmt::format("setting s3-ca: {}: {}", settings.ca_file, std::strerror(errno))};
  const Result<S3Credentials> credentials = read_s3_credentials(settings.credentials_file);
  if (!credentials.ok()) return in_context("setting s3-credentials", credentials.error());
  S3Options options;
  options.endpoint = *endpoint;
  options.region = settings.region;
  options.bucket = location->bucket;
  options.prefix = location->prefix;
  options.addressing =
      settings.addressing == "path" ? S3Addressing::kPath : S3Addressing::kVirtualHost;
  options.ca_file = settings.ca_file;
  options.credentials = *credentials;
  return options;
}

Result<std::optional<std::string>> blobs_at(const std::string& data_folder) {
  const Result<std::optional<PlaceNote>> note = read_note(data_folder, kAt);
  if (!note.ok()) return note.error();
  return *note ? std::optional((*note)->address) : std::nullopt;
}

Status check_place(const std::string& data_folder, const std::string& address, bool has_results) {
  const Result<std::optional<std::string>> noted = blobs_at(data_folder);
  if (!noted.ok()) return noted.error();
  if (*noted && **noted != address) return elsewhere(data_folder, **noted);
  if (*noted || address.empty() || !has_results) return Done{};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("there are results in {} itself: move them first, with `hermite migrate "
                           "--from {} --to {}`",
                           data_folder, data_folder, address)};
}

Status join_to_s3(const std::string& data_folder, S3Blobs& s3) {
  return claim(data_folder, kAt, s3);
}

Status begin_move_to_s3(const std::string& data_folder, S3Blobs& s3) {
  const Result<std::optional<std::string>> at = blobs_at(data_folder);
  if (!at.ok()) return at.error();
  return claim(data_folder, *at ? kAt : kMoving, s3);
}

Status end_move_to_s3(const std::string& data_folder) {
  return rename_in_folder(data_folder, kMoving, kAt);
}

Result<bool> is_in_s3(const std::string& data_folder, const S3Blobs& s3) {
  for (const char* name : {kAt, kMoving}) {
    const Result<std::optional<PlaceNote>> noted = read_note(data_folder, name);
    if (!noted.ok()) return noted.error();
    if (*noted && (*noted)->address == s3.address()) return name == kAt;
  }
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("the results of {} are not in {}: its file blobs-at says otherwise",
                           data_folder, s3.address())};
}

Status leave_s3(const std::string& data_folder) {
  return rename_in_folder(data_folder, kAt, kMoving);
}

Status give_up_prefix(const std::string& data_folder, S3Blobs& s3) {
  if (Status status = s3.remove_owner(); !status.ok()) return status;
  return remove_in_folder(data_folder, kMoving);
}

}  // namespace hermite::server
