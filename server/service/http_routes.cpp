#include "server/service/http_routes.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "server/service/access.h"

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

HttpAnswer json_answer(const Json& json) {
  HttpAnswer answer;
  answer.content_type = "application/json";
  answer.body = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return answer;
}

HttpAnswer refused(const Error& error) {
  switch (error.code) {
    case ErrorCode::kNotFound: return hermite::error_answer(404, error);
    case ErrorCode::kUnauthorized: return hermite::error_answer(401, error);
    case ErrorCode::kBusy: return hermite::error_answer(409, error);
    default: return hermite::error_answer(500, error);
  }
}

HttpAnswer on_route(std::string_view route, HttpAnswer answer) {
  answer.route = route;
  return answer;
}

// "2024-05-01T12:00:00.123Z", null for 0.
Json time_json(std::int64_t unix_ms) {
  if (unix_ms == 0) return nullptr;
  const std::time_t seconds = static_cast<std::time_t>(unix_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32], millis[8];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(millis, sizeof millis, ".%03dZ", static_cast<int>(unix_ms % 1000));
  return std::string(text) + millis;
}

Json row_json(const ScanRow& row) {
  Json json;
  json["id"] = row.id;
  json["title"] = row.title;
  json["state"] = name_of(row.phase);
  json["words"] = row.words;
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

HttpAnswer list_scans(const HttpWorld& world, const std::string&) {
  const Result<std::vector<ScanRow>> rows = world.scans.list();
  if (!rows.ok()) return refused(rows.error());
  Json json = {{"scans", Json::array()}};
  for (const ScanRow& row : *rows) json["scans"].push_back(row_json(row));
  return json_answer(json);
}

HttpAnswer show_scan(const HttpWorld& world, const std::string& id) {
  const Result<ScanRow> row = world.scans.find(id);
  return row.ok() ? json_answer(row_json(*row)) : refused(row.error());
}

HttpAnswer remove_scan(const HttpWorld& world, const std::string& id) {
  const Status status = world.scans.remove(id);
  return status.ok() ? json_answer({{"removed", id}}) : refused(status.error());
}

HttpAnswer send_file(const HttpWorld& world, const std::string& id, const char* name, const char* content_type) {
  Result<std::string> path = world.scans.file_of(id, name);
  if (!path.ok()) return refused(path.error());
  HttpAnswer answer;
  answer.content_type = content_type;
  answer.file = *std::move(path);
  answer.download_name = id + "-" + name;
  return answer;
}

HttpAnswer send_cloud(const HttpWorld& world, const std::string& id) {
  return send_file(world, id, "cloud.ply", "application/octet-stream");
}
HttpAnswer send_trajectory(const HttpWorld& world, const std::string& id) {
  return send_file(world, id, "trajectory.txt", "text/plain; charset=utf-8");
}
HttpAnswer send_report(const HttpWorld& world, const std::string& id) { return send_file(world, id, "report.json", "application/json"); }

struct Route {
  std::string_view method;
  std::string_view name;                 // in metrics
  std::string_view before_id, after_id;  // the path, around an id where has_id
  bool has_id;
  HttpAnswer (*handle)(const HttpWorld&, const std::string& id);
};
constexpr std::array<Route, 6> kApi = {{
    {"GET", "scans", "/api/v1/scans", "", false, list_scans},
    {"GET", "scan", "/api/v1/scans/", "", true, show_scan},
    {"DELETE", "scan", "/api/v1/scans/", "", true, remove_scan},
    {"GET", "cloud.ply", "/api/v1/scans/", "/cloud.ply", true, send_cloud},
    {"GET", "trajectory.txt", "/api/v1/scans/", "/trajectory.txt", true, send_trajectory},
    {"GET", "report.json", "/api/v1/scans/", "/report.json", true, send_report},
}};

// The id inside `path` (empty for a route without one), nothing when the route is for other paths.
std::optional<std::string> match(const Route& route, std::string_view path) {
  if (!route.has_id) return path == route.before_id ? std::optional<std::string>("") : std::nullopt;
  if (path.size() <= route.before_id.size() + route.after_id.size()) return std::nullopt;
  if (path.substr(0, route.before_id.size()) != route.before_id) return std::nullopt;
  if (path.substr(path.size() - route.after_id.size()) != route.after_id) return std::nullopt;
  const std::string_view id = path.substr(route.before_id.size(), path.size() - route.before_id.size() - route.after_id.size());
  return id.find('/') == std::string_view::npos ? std::optional<std::string>(id) : std::nullopt;
}

bool authorized(const HttpWorld& world, const HttpRequest& request) {
  constexpr std::string_view kScheme = "Bearer ";
  const std::string_view given = request.authorization;
  return given.substr(0, kScheme.size()) == kScheme && tokens_equal(given.substr(kScheme.size()), world.token);
}

HttpAnswer wrong_method(const std::string& allow) {
  HttpAnswer answer = error_answer(405, {ErrorCode::kUnsupported, "allowed here: " + allow});
  answer.allow = allow;
  return answer;
}

HttpAnswer answer_api(const HttpWorld& world, const HttpRequest& request, std::string_view method) {
  if (!authorized(world, request))
    return refused({ErrorCode::kUnauthorized, "the header \"Authorization: Bearer TOKEN\" with this server's token is missing"});
  std::string allow;
  for (const Route& route : kApi) {
    const std::optional<std::string> id = match(route, request.path);
    if (!id) continue;
    if (route.method == method) return on_route(route.name, route.handle(world, *id));
    allow += (allow.empty() ? "" : ", ") + std::string(route.method);
  }
  if (!allow.empty()) return wrong_method(allow);
  return refused({ErrorCode::kNotFound, "there is nothing at this path"});
}

HttpAnswer answer_file(const HttpWorld& world, const HttpRequest& request) {
  const auto found = world.files.find(request.path);
  if (found == world.files.end()) {
    const bool no_viewer = request.path == "/" && world.files.empty();
    return refused({ErrorCode::kNotFound, no_viewer ? "this server runs without the web viewer: its files (--web-dir) were not found"
                                                    : "there is nothing at this path"});
  }
  HttpAnswer answer;
  answer.route = "viewer";
  answer.content_type = found->second.content_type;
  answer.cache_control = found->second.immutable ? "public, max-age=31536000, immutable" : "no-cache";
  answer.body = found->second.bytes;
  return answer;
}

}  // namespace

HttpAnswer error_answer(int status, const Error& error) {
  HttpAnswer answer = json_answer({{"error", {{"code", name_of(error.code)}, {"message", error.message}}}});
  answer.status = status;
  return answer;
}

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request) {
  // A HEAD is a GET whose body stays here.
  const std::string_view method = request.method == "HEAD" ? std::string_view("GET") : std::string_view(request.method);
  if (request.path.rfind("/api/", 0) == 0) return answer_api(world, request, method);
  if (method != "GET") return wrong_method("GET, HEAD");
  if (request.path == "/healthz") {
    HttpAnswer healthy;
    healthy.body = "ok\n";
    return on_route("healthz", std::move(healthy));
  }
  return answer_file(world, request);
}

}  // namespace hermite
