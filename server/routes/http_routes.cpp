#include "server/routes/http_routes.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "proto/wire/without_paths.h"
#include "server/operations/json_text.h"
#include "server/routes/comparison_routes.h"
#include "server/routes/edit_routes.h"
#include "server/routes/export_routes.h"
#include "server/routes/frame_routes.h"
#include "server/routes/job_routes.h"
#include "server/routes/measure_routes.h"
#include "server/routes/note_routes.h"
#include "server/routes/result_routes.h"
#include "server/routes/scan_routes.h"
#include "server/routes/token_routes.h"
#include "server/routes/upload_routes.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

HttpAnswer on_route(std::string_view route, HttpAnswer answer) {
  answer.route = route;
  return answer;
}

// Returns the id of what a request has created, from its answer.
std::string made_id(const HttpAnswer& answer) {
  const Json json = Json::parse(answer.body, nullptr, false);
  if (!json.is_object()) return {};
  for (const char* kind : {"token", "share"})
    if (json.contains(kind) && json[kind].is_object()) return json[kind].value("id", "");
  return json.value("id", "");
}

// Writes an entry to the audit log: for changes, whatever their outcome, for downloaded results,
// and for what a token may not do. Lists and states are requested too often to be logged.
void note(const HttpWorld& world, const Call& call, std::string_view route, const std::string& id,
          const std::string& outcome) {
  const HttpRequest& request = call.request;
  world.audit.note({request.caller.now_ms, call.grant.token_id, request.caller.peer,
                    request.method + " " + std::string(route), id, outcome});
}

enum class Needs { kNothing, kView, kScan, kViewAndScan, kAdmin };

struct ApiRoute {
  std::string_view method;
  std::string_view name;  // for metrics
  // The parts of the path around the id; only before_id if there is none.
  std::string_view before_id, after_id;
  bool has_id;
  Needs needs;
  HttpAnswer (*handle)(const HttpWorld&, const Call&);
  bool long_body = false;
  // Name of the last component of the path; empty: the path ends with after_id.
  std::string_view last_part = {};
};
constexpr std::string_view kElementPath = "/hermite-viewer.js";  // web/public
constexpr std::string_view kScanPath = "/api/v1/scans/";
constexpr std::string_view kUploadsPath = "/api/v1/uploads/", kJobsPath = "/api/v1/jobs/";
constexpr std::array<ApiRoute, 55> kApi = {{
    {"GET", "access", "/api/v1/access", "", false, Needs::kNothing, show_access},
    {"GET", "scans", "/api/v1/scans", "", false, Needs::kView, list_scans},
    {"GET", "scan", kScanPath, "", true, Needs::kView, show_scan},
    {"PATCH", "scan", kScanPath, "", true, Needs::kViewAndScan, label_scan},
    {"POST", "stop", kScanPath, "/stop", true, Needs::kViewAndScan, stop_scan},
    {"POST", "pause", kScanPath, "/pause", true, Needs::kViewAndScan, pause_scan},
    {"POST", "unpause", kScanPath, "/unpause", true, Needs::kViewAndScan, unpause_scan},
    {"DELETE", "scan", kScanPath, "", true, Needs::kAdmin, remove_scan},
    {"GET", "cloud.ply", kScanPath, "/cloud.ply", true, Needs::kView, send_cloud},
    {"GET", "trajectory.txt", kScanPath, "/trajectory.txt", true, Needs::kView, send_trajectory},
    {"GET", "report.json", kScanPath, "/report.json", true, Needs::kView, send_report},
    {"GET", "thumbnail.jpg", kScanPath, "/thumbnail.jpg", true, Needs::kView, send_thumbnail},
    {"GET", "exports", kScanPath, "/exports", true, Needs::kView, list_exports},
    {"POST", "exports", kScanPath, "/exports", true, Needs::kView, create_export},
    {"GET", "export", kScanPath, "/exports/", true, Needs::kView, send_export, false, "format"},
    {"DELETE", "export", kScanPath, "/exports/", true, Needs::kViewAndScan, remove_export, false,
     "format"},
    {"GET", "comparisons", kScanPath, "/comparisons", true, Needs::kView, list_comparisons},
    {"POST", "comparisons", kScanPath, "/comparisons", true, Needs::kViewAndScan,
     create_comparison},
    {"GET", "comparison", kScanPath, "/comparisons/", true, Needs::kView, show_comparison, false,
     "other"},
    {"GET", "comparison points", kScanPath, "/compared-points/", true, Needs::kView,
     send_compared_points, false, "other"},
    {"DELETE", "comparison", kScanPath, "/comparisons/", true, Needs::kViewAndScan,
     remove_comparison, false, "other"},
    {"POST", "measure", kScanPath, "/measure", true, Needs::kView, measure_scan, true},
    {"GET", "measurements", kScanPath, "/measurements", true, Needs::kView, list_measurements},
    {"POST", "measurements", kScanPath, "/measurements", true, Needs::kViewAndScan,
     keep_measurement, true},
    {"GET", "measurements.csv", kScanPath, "/measurements.csv", true, Needs::kView,
     send_measurements},
    {"DELETE", "measurement", kScanPath, "/measurements/", true, Needs::kViewAndScan,
     remove_measurement, false, "measurement"},
    {"GET", "notes", kScanPath, "/notes", true, Needs::kView, list_notes},
    {"POST", "notes", kScanPath, "/notes", true, Needs::kViewAndScan, create_note, true},
    {"PATCH", "note", kScanPath, "/notes/", true, Needs::kViewAndScan, change_note, true, "note"},
    {"DELETE", "note", kScanPath, "/notes/", true, Needs::kViewAndScan, remove_note, false, "note"},
    {"GET", "edits", kScanPath, "/edits", true, Needs::kView, show_edits},
    {"PUT", "edits", kScanPath, "/edits", true, Needs::kViewAndScan, change_edits, true},
    {"GET", "frames", kScanPath, "/frames", true, Needs::kView, list_scans_frames},
    {"GET", "frame color", kScanPath, "/frames/color/", true, Needs::kView, send_color, false,
     "frame"},
    {"GET", "frame depth", kScanPath, "/frames/depth/", true, Needs::kView, send_depth, false,
     "frame"},
    {"GET", "frame depth16", kScanPath, "/frames/depth16/", true, Needs::kView, send_raw_depth,
     false, "frame"},
    {"GET", "shares", kScanPath, "/shares", true, Needs::kViewAndScan, list_scans_shares},
    {"POST", "shares", kScanPath, "/shares", true, Needs::kViewAndScan, share_scan},
    {"GET", "shares", "/api/v1/shares", "", false, Needs::kViewAndScan, list_all_shares},
    {"DELETE", "share", "/api/v1/shares/", "", true, Needs::kViewAndScan, revoke_share},
    {"GET", "tokens", "/api/v1/tokens", "", false, Needs::kAdmin, list_all_tokens},
    {"POST", "tokens", "/api/v1/tokens", "", false, Needs::kAdmin, make_token},
    {"DELETE", "token", "/api/v1/tokens/", "", true, Needs::kAdmin, revoke_token},
    {"GET", "uploads", "/api/v1/uploads", "", false, Needs::kScan, list_uploads},
    {"OPTIONS", "uploads", "/api/v1/uploads", "", false, Needs::kScan, describe_uploads},
    {"POST", "uploads", "/api/v1/uploads", "", false, Needs::kScan, create_upload, true},
    {"HEAD", "upload", kUploadsPath, "", true, Needs::kScan, show_upload},
    {"PATCH", "upload", kUploadsPath, "", true, Needs::kScan, continue_upload, true},
    {"DELETE", "upload", kUploadsPath, "", true, Needs::kScan, remove_upload},
    {"PUT", "upload", kUploadsPath, "", true, Needs::kScan, put_upload, true},
    {"GET", "jobs", "/api/v1/jobs", "", false, Needs::kScan, list_jobs},
    {"POST", "jobs", "/api/v1/jobs", "", false, Needs::kViewAndScan, create_job},
    {"GET", "job", kJobsPath, "", true, Needs::kScan, show_job},
    {"DELETE", "job", kJobsPath, "", true, Needs::kScan, cancel_job},
    {"POST", "retry", kJobsPath, "/retry", true, Needs::kScan, retry_job},
}};

// Returns the scope that `grant` lacks for a route, if any.
std::optional<Scope> lacking(const Grant& grant, Needs needs) {
  if (needs == Needs::kNothing) return std::nullopt;
  if (needs == Needs::kAdmin)
    return may(grant, Scope::kAdmin) ? std::nullopt : std::optional(Scope::kAdmin);
  if (needs == Needs::kScan)
    return may(grant, Scope::kScan) ? std::nullopt : std::optional(Scope::kScan);
  if (!may(grant, Scope::kView)) return Scope::kView;
  return needs == Needs::kView || may(grant, Scope::kScan) ? std::nullopt
                                                           : std::optional(Scope::kScan);
}

// The variable parts of a path.
struct PathParts {
  std::string id, last_part;  // empty if the route has none
};

// Returns std::nullopt if the path does not belong to the route.
std::optional<PathParts> match(const ApiRoute& route, std::string_view path) {
  if (!path.starts_with(route.before_id)) return std::nullopt;
  path.remove_prefix(route.before_id.size());
  if (!route.has_id) return path.empty() ? std::optional(PathParts()) : std::nullopt;
  const std::size_t id_end = std::min(path.find('/'), path.size());
  const std::string_view id = path.substr(0, id_end), rest = path.substr(id_end);
  if (id.empty() || !rest.starts_with(route.after_id)) return std::nullopt;
  const std::string_view last_part = rest.substr(route.after_id.size());
  if (last_part.empty() != route.last_part.empty() || last_part.find('/') != std::string_view::npos)
    return std::nullopt;
  return PathParts{std::string(id), std::string(last_part)};
}

// Returns the grant of the caller, or the answer for a caller without one.
std::variant<Grant, HttpAnswer> admit(const HttpWorld& world, const HttpRequest& request) {
  constexpr std::string_view kScheme = "Bearer ";
  const std::string_view given = request.authorization;
  if (given.substr(0, kScheme.size()) != kScheme) {
    world.metrics.authentication_failed();
    return refused(
        {ErrorCode::kUnauthorized,
         "the header \"Authorization: Bearer TOKEN\" with a token of this server is missing"});
  }
  Result<Grant> grant = world.gate.admit(given.substr(kScheme.size()), request.caller);
  if (grant.ok()) return *std::move(grant);
  if (!is_of_store(grant.error())) world.metrics.authentication_failed();
  if (grant.error().code == ErrorCode::kBusy)
    return wait_answer(429, grant.error().message, world.gate.failure_wait_ms());
  return refused(grant.error());
}

HttpAnswer wrong_method(const std::string& allow) {
  HttpAnswer answer = error_answer(405, {ErrorCode::kUnsupported, "allowed here: " + allow});
  answer.allow = allow;
  return answer;
}

// A HEAD is answered as a GET without its body, unless a route handles it.
bool fits(const ApiRoute& route, std::string_view method, std::string_view path) {
  return route.method == method || (method == "HEAD" && route.method == "GET" &&
                                    path.substr(0, kUploadsPath.size()) != kUploadsPath);
}

// The methods of a route of this path, as in the header Allow.
std::string methods_of(const ApiRoute& route, std::string_view path) {
  return std::string(route.method) +
         (route.method == "GET" && fits(route, "HEAD", path) ? ", HEAD" : "");
}

HttpAnswer answer_api(const HttpWorld& world, const HttpRequest& request) {
  const std::string& method = request.method;
  std::variant<Grant, HttpAnswer> admitted = admit(world, request);
  if (auto* refusal = std::get_if<HttpAnswer>(&admitted)) return std::move(*refusal);
  const Grant& grant = std::get<Grant>(admitted);
  if (!may(grant, Scope::kAdmin) && !request.asked_again)
    if (const std::int64_t wait_ms = world.of_a_token.take(grant.token_id, request.caller.now_ms);
        wait_ms > 0)
      return wait_answer(429, "too many requests with this token", wait_ms);
  std::string allow;
  for (const ApiRoute& route : kApi) {
    const std::optional<PathParts> parts = match(route, request.path);
    if (!parts) continue;
    const std::string& id = parts->id;
    const Call call{request, grant, id, parts->last_part};
    if (fits(route, method, request.path)) {
      if (const std::optional<Scope> scope = lacking(grant, route.needs)) {
        spdlog::info("{} {} refused to token {}", method, request.path, grant.token_id);
        note(world, call, route.name, id, "403");
        return on_route(route.name, error_answer(403, lacks(grant, *scope)));
      }
      // A share link must not learn whether other scans exist.
      if (route.before_id == kScanPath && !may_see(grant, id)) {
        note(world, call, route.name, id, "404");
        return on_route(route.name, refused({ErrorCode::kNotFound, "there is no scan " + id}));
      }
      HttpAnswer answer = on_route(route.name, route.handle(world, call));
      // Logs who changed what; the paths of the routes contain ids but no secrets.
      const bool looks =
          method == "GET" || method == "HEAD" || answer.body_sink || answer.ask_again;
      const bool takes_results = method == "GET" && answer.stored.has_value();
      const bool is_begun = answer.body_sink && route.handle != measure_scan;
      if ((!looks && !answer.ask_again) || is_begun || takes_results)
        note(world, call, route.name, id.empty() ? made_id(answer) : id,
             answer.body_sink ? "begun" : std::to_string(answer.status));
      if (!looks)
        spdlog::info("{} {} by token {}: {}", method, request.path, grant.token_id, answer.status);
      return answer;
    }
    allow += (allow.empty() ? "" : ", ") + methods_of(route, request.path);
  }
  if (!allow.empty()) return wrong_method(allow);
  return refused({ErrorCode::kNotFound, "there is nothing at this path"});
}

HttpAnswer answer_file(const HttpWorld& world, const HttpRequest& request) {
  const auto found = world.files.find(request.path);
  if (found == world.files.end()) {
    const bool no_viewer = request.path == "/" && world.files.empty();
    return refused(
        {ErrorCode::kNotFound,
         no_viewer ? "this server runs without the web viewer: its files (--web-dir) were not found"
                   : "there is nothing at this path"});
  }
  HttpAnswer answer;
  answer.route = "viewer";
  answer.content_type = found->second.content_type;
  answer.cache_control =
      found->second.immutable ? "public, max-age=31536000, immutable" : "no-cache";
  answer.body = found->second.bytes;
  answer.frame_ancestors = world.frame_ancestors;
  // Pages of other sites load this one script.
  if (request.path == kElementPath && world.frame_ancestors != kNoFrames)
    answer.headers.push_back({"Cross-Origin-Resource-Policy", "cross-origin"});
  return answer;
}

}  // namespace

HttpAnswer error_answer(int status, const Error& error) {
  return made(json_text(Json{{"error",
                              {{"code", name_of(error.code)},
                               {"message", wire::without_paths(error.message)}}}}),
              status);
}

namespace {

HttpAnswer unavailable(const Error& error) {
  constexpr std::int64_t kRetryIn_s = 2;  // a lost database is connected to again every second
  HttpAnswer answer = server::error_answer(503, error);
  answer.retry_after_s = kRetryIn_s;
  return answer;
}

}  // namespace

HttpAnswer refused(const Error& error) {
  switch (error.code) {
    case ErrorCode::kInvalidArgument: return server::error_answer(400, error);
    case ErrorCode::kNotFound: return server::error_answer(404, error);
    case ErrorCode::kUnauthorized: return server::error_answer(401, error);
    case ErrorCode::kBusy: return server::error_answer(409, error);
    case ErrorCode::kUnavailable: return unavailable(error);
    default: return server::error_answer(500, error);
  }
}

HttpAnswer made(Result<std::string> json, int status) {
  if (!json.ok()) return refused(json.error());
  HttpAnswer answer;
  answer.status = status;
  answer.content_type = "application/json";
  answer.body = *std::move(json);
  return answer;
}

bool takes_long_body(const HttpRequest& request) {
  return std::any_of(kApi.begin(), kApi.end(), [&request](const ApiRoute& route) {
    return route.long_body && route.method == request.method && match(route, request.path);
  });
}

std::vector<std::string> api_routes() {
  std::vector<std::string> routes;
  for (const ApiRoute& route : kApi)
    routes.push_back(fmt::format(
        "{} {}{}{}{}", route.method, route.before_id, route.has_id ? "{id}" : "", route.after_id,
        route.last_part.empty() ? "" : fmt::format("{{{}}}", route.last_part)));
  return routes;
}

HttpAnswer wait_answer(int status, const std::string& message, std::int64_t retry_in_ms) {
  HttpAnswer answer = error_answer(status, {ErrorCode::kBusy, message});
  answer.retry_after_s = (retry_in_ms + 999) / 1000;
  return answer;
}

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request) {
  if (request.path.rfind("/api/", 0) == 0) return answer_api(world, request);
  if (request.method != "GET" && request.method != "HEAD") return wrong_method("GET, HEAD");
  if (request.path == "/healthz") {
    HttpAnswer healthy;
    healthy.body = "ok\n";
    return on_route("healthz", std::move(healthy));
  }
  return answer_file(world, request);
}

}  // namespace hermite::server
