#include "server/client/scans.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "server/client/json_call.h"

namespace hermite::client {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kScans = "/api/v1/scans";
constexpr const char* kShares = "/api/v1/shares";

std::string path_of(const std::string& scan_id, const std::string& rest = "") {
  return std::string(kScans) + "/" + scan_id + rest;
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ScanSummary scan_of(const Json& json) {
  ScanSummary scan;
  scan.id = text_member(json, "id");
  scan.title = text_member(json, "title");
  if (const auto tags = json.find("tags"); tags != json.end() && tags->is_array())
    for (const Json& tag : *tags)
      if (tag.is_string()) scan.tags.push_back(tag);
  scan.state = text_member(json, "state");
  scan.message = text_member(json, "words");
  scan.created_at = text_member(json, "created_at");
  scan.finished_at = text_member(json, "finished_at");
  scan.frames_received = integer_member(json, "frames_received");
  scan.frames_processed = integer_member(json, "frames_processed");
  scan.frames_dropped = integer_member(json, "frames_dropped");
  scan.width_px = integer_member(json, "width");
  scan.height_px = integer_member(json, "height");
  scan.json = line_of(json);
  return scan;
}

ShareSummary share_of(const Json& json) {
  return {text_member(json, "id"),    text_member(json, "scan"),       text_member(json, "name"),
          text_member(json, "state"), text_member(json, "expires_at"), line_of(json)};
}

Result<Json> ask(const ApiTarget& target, const std::string& method, const std::string& path,
                 const Json& body = {}) {
  return json_call(target.server, target.tls,
                   {method, path, {}, body.is_null() ? "" : line_of(body)});
}

Status succeeded(const Result<Json>& answer) {
  return answer.ok() ? Status(Done{}) : Status(answer.error());
}

Result<ScanSummary> one_scan(const Result<Json>& answer) {
  if (!answer.ok()) return answer.error();
  return scan_of(*answer);
}

// Returns the objects in the list of that name in an answer.
std::vector<Json> members(const Json& answer, const char* name) {
  std::vector<Json> objects;
  const auto found = answer.find(name);
  if (found == answer.end() || !found->is_array()) return objects;
  std::copy_if(found->begin(), found->end(), std::back_inserter(objects),
               [](const Json& one) { return one.is_object(); });
  return objects;
}

}  // namespace

Result<std::vector<ScanSummary>> list_scans(const ApiTarget& target, std::size_t at_most) {
  std::vector<ScanSummary> scans;
  std::string path = kScans;
  for (bool more = true; more && scans.size() < at_most;) {
    const Result<Json> answer = ask(target, "GET", path);
    if (!answer.ok()) return answer.error();
    const std::vector<Json> page = members(*answer, "scans");
    for (const Json& one : page)
      if (scans.size() < at_most) scans.push_back(scan_of(one));
    const auto said = answer->find("more");
    more = said != answer->end() && *said == true && !page.empty();
    if (more) path = fmt::format("{}?older-than={}", kScans, text_member(page.back(), "id"));
  }
  return scans;
}

Result<ScanSummary> show_scan(const ApiTarget& target, const std::string& scan_id) {
  return one_scan(ask(target, "GET", path_of(scan_id)));
}

Result<ScanSummary> tag_scan(const ApiTarget& target, const std::string& scan_id,
                             const std::vector<std::string>& tags) {
  return one_scan(ask(target, "PATCH", path_of(scan_id), {{"tags", tags}}));
}

Result<ScanSummary> rename_scan(const ApiTarget& target, const std::string& scan_id,
                                const std::string& title) {
  return one_scan(ask(target, "PATCH", path_of(scan_id), {{"title", title}}));
}

Status stop_scan(const ApiTarget& target, const std::string& scan_id) {
  return succeeded(ask(target, "POST", path_of(scan_id, "/stop")));
}

Status pause_scan(const ApiTarget& target, const std::string& scan_id, bool paused) {
  return succeeded(ask(target, "POST", path_of(scan_id, paused ? "/pause" : "/unpause")));
}

Status delete_scan(const ApiTarget& target, const std::string& scan_id) {
  return succeeded(ask(target, "DELETE", path_of(scan_id)));
}

Result<std::string> share_scan(const ApiTarget& target, const std::string& scan_id,
                               const std::string& name, int days) {
  Json body = Json::object();
  if (!name.empty()) body["name"] = name;
  if (days > 0) body["days"] = days;
  const Result<Json> answer = ask(target, "POST", path_of(scan_id, "/shares"), body);
  if (!answer.ok()) return answer.error();
  const std::string path = text_member(*answer, "path");
  if (path.empty()) return Error{ErrorCode::kIo, "the server's answer has no link"};
  return (target.server.tls ? "https://" : "http://") + target.server.host_and_port() + path;
}

Result<std::vector<ShareSummary>> list_shares(const ApiTarget& target, const std::string& scan_id) {
  const Result<Json> answer =
      ask(target, "GET", scan_id.empty() ? kShares : path_of(scan_id, "/shares"));
  if (!answer.ok()) return answer.error();
  std::vector<ShareSummary> shares;
  for (const Json& one : members(*answer, "shares")) shares.push_back(share_of(one));
  return shares;
}

Status revoke_share(const ApiTarget& target, const std::string& share_id) {
  return succeeded(ask(target, "DELETE", std::string(kShares) + "/" + share_id));
}

}  // namespace hermite::client
