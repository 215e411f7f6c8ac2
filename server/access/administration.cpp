#include "server/access/administration.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "core/digest/sha256.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/store/scan_id.h"
#include "server/store/secret.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kIdBytes = 6;  // 12 hex digits: short enough to type, for a few thousand rows

Error invalid(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

// Parses a request; an empty text is an empty object. Unknown members are refused, so that a
// misspelt limit does not mean no limit.
Result<Json> parse_request(const std::string& request,
                           std::initializer_list<const char*> known_fields) {
  Json json = request.empty() ? Json::object() : Json::parse(request, nullptr, false);
  if (!json.is_object()) return invalid("the request is no JSON object");
  for (const auto& [field, value] : json.items()) {
    bool known = false;
    for (const char* name : known_fields) known = known || field == name;
    if (!known)
      return invalid(
          fmt::format("the field \"{}\" is not known here", field.substr(0, kMaxTokenNameBytes)));
  }
  return json;
}

Result<std::string> name_in(const Json& request) {
  if (!request.contains("name")) return std::string();
  if (!request["name"].is_string()) return invalid("name is no text");
  std::string name = request["name"];
  if (name.size() > kMaxTokenNameBytes)
    return invalid(
        fmt::format("name has {} bytes, allowed are {}", name.size(), kMaxTokenNameBytes));
  // Lists are shown on terminals.
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      return invalid("name has a control character");
  return name;
}

Result<Scopes> scopes_in(const Json& request) {
  if (!request.contains("scopes")) return Scopes{true, true, false};
  const Json& list = request["scopes"];
  Scopes scopes;
  if (!list.is_array() || list.empty()) return invalid("scopes is no list of view, scan, admin");
  for (const Json& item : list) {
    if (item == "view")
      scopes.view = true;
    else if (item == "scan")
      scopes.scan = true;
    else if (item == "admin")
      scopes.admin = true;
    else
      return invalid("scopes has something that is none of view, scan, admin");
  }
  return scopes;
}

struct DaysRange {
  int low, high, otherwise;
};

Result<int> days_in(const Json& request, const DaysRange& range) {
  if (!request.contains("days")) return range.otherwise;
  const Json& days = request["days"];
  if (!days.is_number_integer() || days < range.low || days > range.high)
    return invalid(fmt::format("days is no whole number from {} to {}", range.low, range.high));
  return days.get<int>();
}

// Returns a row that expires in `days`, and its secret, of which the row has only the hash.
std::pair<TokenRow, std::string> new_row(std::string_view prefix, const std::string& name, int days,
                                         std::int64_t now_ms) {
  std::string secret = new_secret(prefix);
  TokenRow row;
  row.id = random_hex(kIdBytes);
  row.secret_sha256 = digest::sha256(secret);
  row.name = name;
  row.created_at_ms = now_ms;
  row.expires_at_ms = days == 0 ? 0 : now_ms + days * kDay_ms;
  return {std::move(row), std::move(secret)};
}

const char* state_of(const TokenRow& row, std::int64_t now_ms) {
  if (row.revoked_at_ms != 0) return "revoked";
  return row.expires_at_ms != 0 && now_ms >= row.expires_at_ms ? "expired" : "active";
}

Json row_json(const TokenRow& row, std::int64_t now_ms) {
  Json json = {{"id", row.id}, {"name", row.name}};
  if (row.scan_id.empty()) {
    json["scopes"] = Json::array();
    for (const Scope scope : kAllScopes)
      if (includes(row.scopes, scope)) json["scopes"].push_back(name_of(scope));
  } else {
    json["scan"] = row.scan_id;
  }
  json["created_at"] = time_json(row.created_at_ms);
  json["expires_at"] = time_json(row.expires_at_ms);
  json["used_at"] = time_json(row.used_at_ms);
  json["revoked_at"] = time_json(row.revoked_at_ms);
  json["state"] = state_of(row, now_ms);
  return json;
}

// Lists the rows for which `wanted` returns true, as {name: [...]}.
template <class Wanted>
Result<std::string> list_rows(Store& store, const char* name, std::int64_t now_ms, Wanted wanted) {
  const Result<std::vector<TokenRow>> rows = store.tokens.list();
  if (!rows.ok()) return rows.error();
  Json list = Json::array();
  for (const TokenRow& row : *rows)
    if (wanted(row)) list.push_back(row_json(row, now_ms));
  return json_text({{name, std::move(list)}});
}

}  // namespace

Result<std::string> create_token(Store& store, const std::string& request, std::int64_t now_ms,
                                 const std::string& made_by) {
  const Result<Json> json = parse_request(request, {"name", "scopes", "days"});
  if (!json.ok()) return json.error();
  const Result<std::string> name = name_in(*json);
  if (!name.ok()) return name.error();
  const Result<Scopes> scopes = scopes_in(*json);
  if (!scopes.ok()) return scopes.error();
  const Result<int> days = days_in(*json, {0, kMaxTokenDays, kDefaultTokenDays});
  if (!days.ok()) return days.error();
  auto [row, secret] = new_row(kTokenPrefix, *name, *days, now_ms);
  row.scopes = *scopes;
  row.made_by = made_by;
  if (Status status = store.tokens.add(row); !status.ok()) return status.error();
  return json_text({{"token", row_json(row, now_ms)}, {"secret", secret}});
}

Result<std::string> create_share(Store& store, const std::string& scan_id,
                                 const std::string& request, std::int64_t now_ms,
                                 const std::string& made_by) {
  const Result<Json> json = parse_request(request, {"name", "days"});
  if (!json.ok()) return json.error();
  const Result<std::string> name = name_in(*json);
  if (!name.ok()) return name.error();
  const Result<int> days = days_in(*json, {1, kMaxShareDays, kDefaultShareDays});
  if (!days.ok()) return days.error();
  auto [row, secret] = new_row(kSharePrefix, *name, *days, now_ms);
  row.scopes = {true, false, false};
  row.scan_id = scan_id;
  row.made_by = made_by;
  // An empty id would create a token for all scans.
  if (!is_scan_id(scan_id))
    return Error{ErrorCode::kNotFound,
                 "there is no such scan: an id has 26 characters of a-z and 0-9"};
  if (Status status = store.tokens.add(row); !status.ok()) return status.error();
  const std::string path = fmt::format("/#share={}&scan={}", secret, scan_id);
  return json_text({{"share", row_json(row, now_ms)}, {"secret", secret}, {"path", path}});
}

Result<std::string> list_tokens(Store& store, std::int64_t now_ms) {
  return list_rows(store, "tokens", now_ms,
                   [](const TokenRow& row) { return row.scan_id.empty(); });
}

Result<std::string> list_shares(Store& store, const std::string& scan_id, std::int64_t now_ms) {
  return list_rows(store, "shares", now_ms, [&scan_id](const TokenRow& row) {
    return !row.scan_id.empty() && (scan_id.empty() || row.scan_id == scan_id);
  });
}

Result<std::string> revoke_row(Store& store, const std::string& id, bool share,
                               std::int64_t now_ms) {
  const Result<TokenRow> row = store.tokens.find(id);
  if (!row.ok()) return row.error();
  if (row->scan_id.empty() == share)
    return Error{ErrorCode::kNotFound,
                 fmt::format("there is no {}{}", share ? "share link " : "token ", row->id)};
  if (Status status = store.tokens.revoke(id, now_ms); !status.ok()) return status.error();
  return json_text({{"revoked", id}});
}

}  // namespace hermite::server
