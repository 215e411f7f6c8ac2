#include "server/routes/scan_routes.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "core/base/utf8.h"
#include "proto/wire/messages.h"
#include "proto/wire/without_paths.h"
#include "server/exports/exports.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/routes/measuring_cache.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

Status check_text(const std::string& field, const std::string& text, std::size_t max_bytes) {
  if (text.empty() || text.size() > max_bytes)
    return Error{ErrorCode::kInvalidArgument, fmt::format("{} has {} bytes, allowed are 1 to {}",
                                                          field, text.size(), max_bytes)};
  if (std::any_of(text.begin(), text.end(), is_control))
    return Error{ErrorCode::kInvalidArgument, field + " has a control character"};
  return Done{};
}

// Returns them sorted, each once.
Result<std::vector<std::string>> tags_in(const Json& json) {
  if (!json.is_array()) return Error{ErrorCode::kInvalidArgument, "tags is no list of texts"};
  std::set<std::string> tags;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string field = fmt::format("tags[{}]", i);
    if (!json[i].is_string()) return Error{ErrorCode::kInvalidArgument, field + " is no text"};
    const std::string tag = json[i];
    if (const Status status = check_text(field, tag, kMaxTagBytes); !status.ok())
      return status.error();
    if (tag.front() == ' ' || tag.back() == ' ')
      return Error{ErrorCode::kInvalidArgument, field + " begins or ends with a space"};
    tags.insert(tag);
  }
  if (tags.size() > kMaxTagsPerScan)
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("tags has {} different ones, allowed are {}", tags.size(), kMaxTagsPerScan)};
  return std::vector<std::string>(tags.begin(), tags.end());
}

Result<ScanLabels> labels_in(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  const bool has_title = json.is_object() && json.contains("title"),
             has_tags = json.is_object() && json.contains("tags");
  if ((!has_title && !has_tags) || json.size() != std::size_t{has_title} + std::size_t{has_tags})
    return Error{
        ErrorCode::kInvalidArgument,
        "the request is no JSON object with a \"title\", \"tags\" or both, and nothing else"};
  ScanLabels labels;
  if (has_title) {
    if (!json["title"].is_string()) return Error{ErrorCode::kInvalidArgument, "title is no text"};
    labels.title = json["title"].get<std::string>();
    if (const Status status = check_title("title", *labels.title); !status.ok())
      return status.error();
  }
  if (has_tags) {
    Result<std::vector<std::string>> tags = tags_in(json["tags"]);
    if (!tags.ok()) return tags.error();
    labels.tags = *std::move(tags);
  }
  return labels;
}

Json row_json(const ScanRow& row) {
  Json json;
  json["id"] = row.id;
  json["title"] = row.title;
  json["tags"] = row.tags;
  json["state"] = name_of(row.phase);
  json["words"] = wire::without_paths(row.message);
  json["to_be_rebuilt"] = row.to_be_rebuilt;
  json["frames"] = row.frames_processed;
  json["frames_received"] = row.frames_received;
  json["frames_processed"] = row.frames_processed;
  json["frames_dropped"] = row.frames_dropped;
  json["width"] = row.camera.width;
  json["height"] = row.camera.height;
  json["started"] = time_json(row.created_at_ms);
  json["created_at"] = time_json(row.created_at_ms);
  json["finished_at"] = time_json(row.finished_at_ms);
  return json;
}

// For a share link only its scan, which need not be among the newest.
Result<std::vector<ScanRow>> scans_for(const HttpWorld& world, const Grant& grant,
                                       const std::string& older_than_id) {
  if (grant.scan_id.empty()) return world.scans.rows().list(older_than_id);
  Result<ScanRow> row = world.scans.rows().find(grant.scan_id);
  if (!row.ok()) return row.error();
  return std::vector<ScanRow>{*std::move(row)};
}

}  // namespace

std::optional<HttpAnswer> keep_out(const HttpWorld& world, const Call& call) {
  const Result<ScanRow> row = world.scans.rows().find(call.id);
  if (!row.ok()) return refused(row.error());
  if (row->token_id == call.grant.token_id || may(call.grant, Scope::kAdmin)) return std::nullopt;
  return error_answer(403,
                      {ErrorCode::kUnauthorized, "this scan is another token's; admin is needed"});
}

Status check_title(const std::string& field, const std::string& text) {
  return check_text(field, text, wire::kMaxTitleBytes);
}

HttpAnswer show_access(const HttpWorld& world, const Call& call) {
  Json json = {{"scopes", Json::array()},
               {"scan", call.grant.scan_id.empty() ? Json() : Json(call.grant.scan_id)}};
  for (const Scope scope : kAllScopes)
    if (may(call.grant, scope)) json["scopes"].push_back(name_of(scope));
  json["embedding"] = world.frame_ancestors != kNoFrames;
  return made(json_text(json));
}

HttpAnswer list_scans(const HttpWorld& world, const Call& call) {
  constexpr std::string_view kOlder = "older-than=";
  const std::string& query = call.request.query;
  if (!query.empty() && !query.starts_with(kOlder))
    return refused(
        {ErrorCode::kInvalidArgument, "the list of scans knows ?older-than=ID and nothing else"});
  const Result<std::vector<ScanRow>> rows =
      scans_for(world, call.grant, query.empty() ? "" : query.substr(kOlder.size()));
  if (!rows.ok()) return refused(rows.error());
  Json json = {{"scans", Json::array()}, {"more", rows->size() == kMaxListedScans}};
  for (const ScanRow& row : *rows) json["scans"].push_back(row_json(row));
  return made(json_text(json));
}

HttpAnswer show_scan(const HttpWorld& world, const Call& call) {
  const Result<ScanRow> row = world.scans.rows().find(call.id);
  return row.ok() ? made(json_text(row_json(*row))) : refused(row.error());
}

HttpAnswer remove_scan(const HttpWorld& world, const Call& call) {
  if (world.scans.rows().find(call.id).ok()) world.exports.forget_comparisons_with(call.id);
  const Status status = world.scans.remove(call.id);
  if (status.ok()) world.measuring.forget(call.id);
  return status.ok() ? made(json_text(Json{{"removed", call.id}})) : refused(status.error());
}

HttpAnswer label_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Result<ScanLabels> labels = labels_in(call.request.body);
  if (!labels.ok()) return refused(labels.error());
  if (Status status = world.scans.label(call.id, *labels); !status.ok())
    return refused(status.error());
  return show_scan(world, call);
}

namespace {

HttpAnswer ask_to_pause(const HttpWorld& world, const Call& call, bool paused) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  LiveScan* const scan = world.scans.running(call.id);
  if (!scan) return refused({ErrorCode::kBusy, fmt::format("scan {} does not run", call.id)});
  if (Status status = scan->ask_to_pause(paused); !status.ok()) return refused(status.error());
  return made(json_text(Json{{"asked", paused ? "pause" : "unpause"}}), 202);
}

}  // namespace

HttpAnswer pause_scan(const HttpWorld& world, const Call& call) {
  return ask_to_pause(world, call, true);
}

HttpAnswer unpause_scan(const HttpWorld& world, const Call& call) {
  return ask_to_pause(world, call, false);
}

HttpAnswer stop_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  if (Status status = world.scans.end(call.id); !status.ok()) return refused(status.error());
  return made(json_text(Json{{"stopping", call.id}}));
}

}  // namespace hermite::server
