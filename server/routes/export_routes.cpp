#include "server/routes/export_routes.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "proto/wire/without_paths.h"
#include "server/exports/exports.h"
#include "server/operations/json_text.h"
#include "server/routes/result_routes.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kFarTooMany = std::int64_t{1} << 60;  // exceeds every limit
// About how long the mesh of a room takes.
constexpr std::int64_t kRetry_ms = 10'000;

Json export_json(const ExportState& state) {
  const ExportOffer& format = *state.format;
  Json json;
  const ExportSpec spec{&format, state.shape};
  json["format"] = spec.name();
  json["kind"] = name_of(format.kind);
  json["label"] = format.label;
  json["file"] = spec.file();
  json["of_format"] = format.name;
  json["simplify_um"] = state.shape.simplify_um;
  json["triangles"] = state.shape.triangles;
  json["fill_holes_mm"] = state.shape.fill_mm;
  json["close"] = state.shape.closes;
  json["state"] = name_of(state.phase);
  json["bytes"] = state.size_bytes;
  json["done"] = state.done;
  json["words"] = wire::without_paths(state.message);
  return json;
}

constexpr const char* kBodyMessage =
    "the body must be {\"format\": NAME} with, of a mesh, any of \"simplify_um\", \"triangles\", "
    "\"fill_holes_mm\" (whole numbers) and "
    "\"close\" (true or false), and nothing else";

// Returns the name of the requested export.
Result<std::string> format_of(const std::string& body) {
  const Error wrong{ErrorCode::kInvalidArgument, kBodyMessage};
  const Json json = Json::parse(body, nullptr, false);
  const auto format = json.is_object() ? json.find("format") : json.end();
  if (!json.is_object() || format == json.end() || !format->is_string()) return wrong;
  Result<ExportSpec> spec = export_spec_named(format->get<std::string>());
  if (!spec.ok()) return spec.error();
  MeshShape& shape = spec->shape;
  for (const auto& [field, value] : json.items()) {
    std::int64_t* const number = field == "simplify_um"     ? &shape.simplify_um
                                 : field == "triangles"     ? &shape.triangles
                                 : field == "fill_holes_mm" ? &shape.fill_mm
                                                            : nullptr;
    if (number && value.is_number_integer()) {
      *number = value.is_number_unsigned() && value.get<std::uint64_t>() > kFarTooMany
                    ? kFarTooMany
                    : value.get<std::int64_t>();
    } else if (field == "close" && value.is_boolean()) {
      shape.closes = value.get<bool>();
    } else if (field != "format") {
      return wrong;
    }
  }
  if (const Status checked = check_shape(*spec->offer, shape); !checked.ok())
    return checked.error();
  return spec->name();
}

}  // namespace

HttpAnswer list_exports(const HttpWorld& world, const Call& call) {
  const Result<std::vector<ExportState>> states = world.exports.list(call.id);
  if (!states.ok()) return refused(states.error());
  Json json = {{"exports", Json::array()}};
  for (const ExportState& state : *states) json["exports"].push_back(export_json(state));
  return made(json_text(json));
}

HttpAnswer create_export(const HttpWorld& world, const Call& call) {
  const Result<std::string> format = format_of(call.request.body);
  // An invalid body must not be reported as 404.
  if (!format.ok()) return error_answer(400, {ErrorCode::kInvalidArgument, format.error().message});
  if (!call.grant.scan_id.empty() && *format != kViewerMesh)
    return error_answer(403, {ErrorCode::kUnauthorized,
                              fmt::format("a share link may ask for {} alone; other exports can be "
                                          "taken when somebody else has asked for them",
                                          kViewerMesh)});
  const Result<ExportState> before = world.exports.state(call.id, *format);
  if (!before.ok()) return refused(before.error());
  const bool there =
      before->phase != ExportPhase::kMissing && before->phase != ExportPhase::kFailed;
  if (!there)
    if (const Status room = world.scans.room().check_storage_of(call.id); !room.ok())
      return room.error().code == ErrorCode::kBusy
                 ? wait_answer(503, room.error().message, kRetry_ms)
                 : refused(room.error());
  const Status asked = world.exports.request(
      {call.id, *format, call.grant.token_id, may(call.grant, Scope::kAdmin)});
  if (!asked.ok())
    return asked.error().code == ErrorCode::kBusy
               ? wait_answer(503, asked.error().message, kRetry_ms)
               : refused(asked.error());
  const Result<ExportState> state = world.exports.state(call.id, *format);
  return state.ok()
             ? made(json_text(export_json(*state)), state->phase == ExportPhase::kReady ? 200 : 202)
             : refused(state.error());
}

HttpAnswer send_export(const HttpWorld& world, const Call& call) {
  const Result<ExportState> state = world.exports.state(call.id, call.last_part);
  if (!state.ok()) return refused(state.error());
  const std::string file = ExportSpec{state->format, state->shape}.file();
  if (state->phase == ExportPhase::kReady)
    return send_file(world, call, file, state->format->content_type);
  std::string message =
      fmt::format("scan {} has no {}: it is {}", call.id, file, name_of(state->phase));
  if (!state->message.empty()) message += ", " + state->message;
  return refused({ErrorCode::kNotFound, message});
}

HttpAnswer remove_export(const HttpWorld& world, const Call& call) {
  const Status removed = world.exports.remove(call.id, call.last_part);
  return removed.ok() ? made(json_text({{"removed", call.last_part}})) : refused(removed.error());
}

}  // namespace hermite::server
