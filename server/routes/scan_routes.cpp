#include "server/routes/scan_routes.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "proto/wire/messages.h"
#include "proto/wire/without_paths.h"
#include "server/exports/exports.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/routes/measuring_cache.h"

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

Result<std::string> title_in(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || json.size() != 1 || !json.contains("title") || !json["title"].is_string())
    return Error{ErrorCode::kInvalidArgument, "the request is no JSON object with a \"title\" that is text, and nothing else"};
  std::string title = json["title"];
  if (const Status status = check_title("title", title); !status.ok()) return status.error();
  return title;
}

Json row_json(const ScanRow& row) {
  Json json;
  json["id"] = row.id;
  json["title"] = row.title;
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
Result<std::vector<ScanRow>> scans_for(const HttpWorld& world, const Grant& grant, const std::string& older_than_id) {
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
  return error_answer(403, {ErrorCode::kUnauthorized, "this scan is another token's; admin is needed"});
}

Status check_title(const std::string& field, const std::string& text) {
  if (text.empty() || text.size() > wire::kMaxTitleBytes)
    return Error{ErrorCode::kInvalidArgument,
                 field + " has " + std::to_string(text.size()) + " bytes, allowed are 1 to " + std::to_string(wire::kMaxTitleBytes)};
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control)) return Error{ErrorCode::kInvalidArgument, field + " has a control character"};
  return Done{};
}

HttpAnswer show_access(const HttpWorld& world, const Call& call) {
  Json json = {{"scopes", Json::array()}, {"scan", call.grant.scan_id.empty() ? Json() : Json(call.grant.scan_id)}};
  for (const Scope scope : kAllScopes)
    if (may(call.grant, scope)) json["scopes"].push_back(name_of(scope));
  json["embedding"] = world.frame_ancestors != kNoFrames;
  return made(json_text(json));
}

HttpAnswer list_scans(const HttpWorld& world, const Call& call) {
  constexpr std::string_view kOlder = "older-than=";
  const std::string& query = call.request.query;
  if (!query.empty() && !query.starts_with(kOlder))
    return refused({ErrorCode::kInvalidArgument, "the list of scans knows ?older-than=ID and nothing else"});
  const Result<std::vector<ScanRow>> rows = scans_for(world, call.grant, query.empty() ? "" : query.substr(kOlder.size()));
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

HttpAnswer rename_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Result<std::string> title = title_in(call.request.body);
  if (!title.ok()) return refused(title.error());
  if (Status status = world.scans.rename(call.id, *title); !status.ok()) return refused(status.error());
  return show_scan(world, call);
}

HttpAnswer stop_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  if (Status status = world.scans.end(call.id); !status.ok()) return refused(status.error());
  return made(json_text(Json{{"stopping", call.id}}));
}

}  // namespace hermite
