#include "server/routes/comparison_routes.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "proto/wire/without_paths.h"
#include "server/exports/exports.h"
#include "server/operations/json_text.h"
#include "server/routes/result_routes.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

// About how long the comparison of a room takes.
constexpr std::int64_t kComparisonRetry_ms = 10'000;

Json comparison_json(const ExportState& state) {
  return {{"with", state.other_scan_id},
          {"state", name_of(state.phase)},
          {"done", state.phase == ExportPhase::kReady ? 1.0 : state.done},
          {"words", wire::without_paths(state.message)}};
}

// A comparison shows what is in the other scan, too.
std::optional<HttpAnswer> of_share_link(const Call& call) {
  if (call.grant.scan_id.empty()) return std::nullopt;
  return error_answer(403, {ErrorCode::kUnauthorized,
                            "a share link shows one scan and no comparison with another"});
}

Result<std::string> other_scan_in(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || json.size() != 1 || !json.contains("with") ||
      !json["with"].is_string() || !is_scan_id(json["with"].get<std::string>()))
    return Error{ErrorCode::kInvalidArgument,
                 "the body must be {\"with\": ID} with the id of another scan, and nothing else"};
  return json["with"].get<std::string>();
}

HttpAnswer busy_answer(const Error& error) {
  return error.code == ErrorCode::kBusy ? wait_answer(503, error.message, kComparisonRetry_ms)
                                        : refused(error);
}

Result<ExportState> compared_state(const HttpWorld& world, const Call& call) {
  if (!is_scan_id(call.last_part))
    return Error{ErrorCode::kNotFound, "there is no scan " + call.last_part};
  return world.exports.comparison(call.id, call.last_part);
}

HttpAnswer with_report(Blobs& blobs, const std::string& scan_id, const ExportState& state) {
  const Result<std::string> text = read_blob(
      blobs, scan_id, comparison_with(state.other_scan_id).file(), kMaxComparisonReport_bytes);
  if (!text.ok()) return refused(text.error());
  Json json = comparison_json(state);
  Json report = Json::parse(*text, nullptr, false);
  if (!report.is_object())
    return refused({ErrorCode::kCorruptData,
                    "the report of the comparison cannot be read: remove it and ask again"});
  json["report"] = std::move(report);
  return made(json_text(json));
}

}  // namespace

HttpAnswer list_comparisons(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = of_share_link(call)) return *std::move(no);
  const Result<std::vector<ExportState>> states = world.exports.list_comparisons(call.id);
  if (!states.ok()) return refused(states.error());
  Json json = {{"comparisons", Json::array()}};
  for (const ExportState& state : *states) json["comparisons"].push_back(comparison_json(state));
  return made(json_text(json));
}

HttpAnswer create_comparison(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = of_share_link(call)) return *std::move(no);
  const Result<std::string> other = other_scan_in(call.request.body);
  if (!other.ok()) return refused(other.error());
  const Result<ExportState> before = world.exports.comparison(call.id, *other);
  if (!before.ok()) return refused(before.error());
  const bool is_there =
      before->phase != ExportPhase::kMissing && before->phase != ExportPhase::kFailed;
  if (!is_there)
    if (const Status room = world.scans.room().check_storage_of(call.id); !room.ok())
      return busy_answer(room.error());
  const Status asked = world.exports.request_comparison(
      {call.id, {}, call.grant.token_id, may(call.grant, Scope::kAdmin)}, *other);
  if (!asked.ok()) return busy_answer(asked.error());
  const Result<ExportState> state = world.exports.comparison(call.id, *other);
  return state.ok() ? made(json_text(comparison_json(*state)),
                           state->phase == ExportPhase::kReady ? 200 : 202)
                    : refused(state.error());
}

HttpAnswer show_comparison(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = of_share_link(call)) return *std::move(no);
  const Result<ExportState> state = compared_state(world, call);
  if (!state.ok()) return refused(state.error());
  if (state->phase != ExportPhase::kReady) return made(json_text(comparison_json(*state)));
  HttpAnswer answer;
  answer.work = [&blobs = world.scans.blobs(), scan_id = call.id, state = *state] {
    return with_report(blobs, scan_id, state);
  };
  return answer;
}

HttpAnswer send_compared_points(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = of_share_link(call)) return *std::move(no);
  const Result<ExportState> state = compared_state(world, call);
  if (!state.ok()) return refused(state.error());
  if (state->phase == ExportPhase::kReady)
    return send_file(world, call, comparison_points_file(call.last_part),
                     "application/octet-stream");
  return refused({ErrorCode::kNotFound, std::string("the comparison is ") + name_of(state->phase)});
}

HttpAnswer remove_comparison(const HttpWorld& world, const Call& call) {
  const Result<ExportState> state = compared_state(world, call);
  if (!state.ok()) return refused(state.error());
  if (state->phase == ExportPhase::kMissing)
    return refused({ErrorCode::kNotFound,
                    fmt::format("scan {} has no comparison with {}", call.id, call.last_part)});
  const Status removed = world.exports.remove_comparison(call.id, call.last_part);
  return removed.ok() ? made(json_text({{"removed", call.last_part}})) : refused(removed.error());
}

}  // namespace hermite::server
