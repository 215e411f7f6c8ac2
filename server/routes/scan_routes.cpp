#include "server/routes/scan_routes.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "proto/wire/messages.h"
#include "server/operations/json_text.h"

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

}  // namespace

std::optional<HttpAnswer> keep_out(const HttpWorld& world, const Call& call) {
  const Result<ScanRow> row = world.scans.find(call.id);
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

HttpAnswer show_access(const HttpWorld&, const Call& call) {
  Json json = {{"scopes", Json::array()}, {"scan", call.grant.scan_id.empty() ? Json() : Json(call.grant.scan_id)}};
  for (const Scope scope : kAllScopes)
    if (may(call.grant, scope)) json["scopes"].push_back(name_of(scope));
  return made(json_text(json));
}

HttpAnswer rename_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Result<std::string> title = title_in(call.request.body);
  if (!title.ok()) return refused(title.error());
  if (Status status = world.scans.rename(call.id, *title); !status.ok()) return refused(status.error());
  return made(json_text(Json{{"id", call.id}, {"title", *title}}));
}

HttpAnswer stop_scan(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  if (Status status = world.scans.end(call.id); !status.ok()) return refused(status.error());
  return made(json_text(Json{{"stopping", call.id}}));
}

}  // namespace hermite
