#include "server/routes/note_routes.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/printf_text.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/routes/gathered_body.h"
#include "server/routes/scan_routes.h"
#include "server/store/note_row.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;
using Triple = std::array<double, 3>;

constexpr double kNearestTarget_m = 1e-3;  // nearer ones give no direction

Json note_json(const NoteRow& row) {
  Json json = {{"id", row.id},
               {"position_m", row.position_m},
               {"view", nullptr},
               {"text", row.text},
               {"version", row.version}};
  if (row.view)
    json["view"] = {{"position_m", row.view->position_m}, {"target_m", row.view->target_m}};
  json["created_at"] = time_json(row.created_at_ms);
  json["changed_at"] = time_json(row.changed_at_ms);
  return json;
}

Error invalid_note(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

// JSON has no NaN and no infinity.
Result<Triple> position_in(const Json& json, const std::string& field) {
  const Error wrong = invalid_note(field + " must be three numbers, [x, y, z] in metres");
  if (!json.is_array() || json.size() != 3) return wrong;
  Triple position_m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!json[axis].is_number()) return wrong;
    position_m[axis] = json[axis].get<double>();
    if (std::abs(position_m[axis]) > kFarthestNote_m)
      return invalid_note(
          fmt::format("{}[{}]{}", field, axis,
                      printf_text(" is %g, allowed are %.0f to %.0f", position_m[axis],
                                  -kFarthestNote_m, kFarthestNote_m)));
  }
  return position_m;
}

Result<NoteView> view_in(const Json& json) {
  if (!json.is_object() || json.size() != 2 || !json.contains("position_m") ||
      !json.contains("target_m"))
    return invalid_note("view must have \"position_m\" and \"target_m\", and nothing else");
  const Result<Triple> position = position_in(json["position_m"], "view.position_m");
  if (!position.ok()) return position.error();
  const Result<Triple> target = position_in(json["target_m"], "view.target_m");
  if (!target.ok()) return target.error();
  const NoteView view{*position, *target};
  const auto along_m = [&view](std::size_t axis) {
    return view.target_m[axis] - view.position_m[axis];
  };
  if (std::hypot(along_m(0), along_m(1), along_m(2)) < kNearestTarget_m)
    return invalid_note(
        "view.target_m is the same place as view.position_m: they must be 1 mm apart or more");
  return view;
}

// Newlines are the only control characters of a text. Those from U+0080 to U+009F have two bytes.
bool has_control_character(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\n') || byte == 0x7f) return true;
    if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0)
      return true;
  }
  return false;
}

Result<std::string> text_in(const Json& json) {
  const auto found = json.find("text");
  if (found == json.end() || !found->is_string())
    return invalid_note("text is missing, or no text");
  std::string text = found->get<std::string>();
  if (text.empty() || text.size() > kMaxNoteTextBytes)
    return invalid_note(
        fmt::format("text has {} bytes, allowed are 1 to {}", text.size(), kMaxNoteTextBytes));
  if (has_control_character(text))
    return invalid_note("text has a control character that is no newline");
  return text;
}

Result<NoteRow> new_note_in(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object())
    return invalid_note("the body must be a JSON object with \"position_m\" and \"text\"");
  for (const auto& [field, value] : json.items())
    if (field != "position_m" && field != "text" && field != "view")
      return invalid_note(
          "the body may have \"position_m\", \"text\" and \"view\", and nothing else");
  NoteRow row;
  const Result<Triple> position = position_in(json.value("position_m", Json()), "position_m");
  if (!position.ok()) return position.error();
  row.position_m = *position;
  if (const auto given = json.find("view"); given != json.end() && !given->is_null()) {
    const Result<NoteView> view = view_in(*given);
    if (!view.ok()) return view.error();
    row.view = *view;
  }
  Result<std::string> text = text_in(json);
  if (!text.ok()) return text.error();
  row.text = *std::move(text);
  return row;
}

// The text, and the version that is changed.
Result<NoteRow> changed_note_in(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || json.size() != 2 || !json.contains("text") || !json.contains("version"))
    return invalid_note(
        "the body must be a JSON object with \"text\" and \"version\", and nothing else");
  const Json& version = json["version"];
  if (!version.is_number_integer() || version.get<std::int64_t>() < 1)
    return invalid_note(
        "version must be the version of the note that is changed: a whole number from 1");
  Result<std::string> text = text_in(json);
  if (!text.ok()) return text.error();
  NoteRow row;
  row.version = version.get<std::int64_t>();
  row.text = *std::move(text);
  return row;
}

// Says so, and has the note as it is now.
HttpAnswer changed_meanwhile(const NoteRow& now) {
  HttpAnswer answer = error_answer(
      409, {ErrorCode::kBusy, fmt::format("the note has version {} by now: somebody has changed it "
                                          "meanwhile, and it stays as it is",
                                          now.version)});
  Json json = Json::parse(answer.body);
  json["note"] = note_json(now);
  answer.body = json_text(json);
  return answer;
}

// Receives the body of a request, and writes the note once it is complete.
class NoteBody : public GatheredBody {
 public:
  // `is_new`: the body is that of POST.
  NoteBody(const HttpWorld& world, const Call& call, bool is_new)
      : GatheredBody(world, call),
        note_id_(is_new ? new_scan_id() : call.last_part),
        is_new_(is_new) {}

  void close(bool complete) override {
    if (complete) note_ = is_new_ ? new_note_in(body_) : changed_note_in(body_);
  }
  HttpAnswer answer() override {
    if (!note_.ok()) return refused(note_.error());
    NoteRow row = *std::move(note_);
    row.id = note_id_;
    row.scan_id = scan_id_;
    row.changed_at_ms = unix_now_ms();
    return is_new_ ? added(std::move(row)) : changed(row);
  }

 private:
  HttpAnswer added(NoteRow row) const {
    row.created_at_ms = row.changed_at_ms;
    if (const Status status = world_.store.notes.add(row); !status.ok())
      return refused(status.error());
    return made(json_text(note_json(row)), 201);
  }
  HttpAnswer changed(const NoteRow& row) const {
    const Result<NoteOutcome> outcome = world_.store.notes.change_text(row);
    if (!outcome.ok()) return refused(outcome.error());
    return outcome->is_done ? made(json_text(note_json(outcome->note)))
                            : changed_meanwhile(outcome->note);
  }

  const std::string note_id_;
  const bool is_new_;
  Result<NoteRow> note_ = Error{ErrorCode::kInvalidArgument, "the body did not come whole"};
};

HttpAnswer receive_note(const HttpWorld& world, const Call& call, bool is_new) {
  if (std::optional<HttpAnswer> no = wrong_size(call, kMaxNoteBodyBytes)) return *std::move(no);
  return received_into(std::make_shared<NoteBody>(world, call, is_new));
}

std::optional<std::int64_t> version_in(const std::string& query) {
  constexpr std::string_view kVersion = "version=";
  if (!query.starts_with(kVersion)) return std::nullopt;
  std::int64_t version = 0;
  const char* const end = query.data() + query.size();
  const auto [rest, error] = std::from_chars(query.data() + kVersion.size(), end, version);
  return error == std::errc() && rest == end && version >= 1 ? std::optional(version)
                                                             : std::nullopt;
}

}  // namespace

HttpAnswer list_notes(const HttpWorld& world, const Call& call) {
  if (const Result<ScanRow> row = world.scans.rows().find(call.id); !row.ok())
    return refused(row.error());
  const Result<std::vector<NoteRow>> rows = world.store.notes.of_scan(call.id);
  if (!rows.ok()) return refused(rows.error());
  Json json = {{"notes", Json::array()}};
  for (const NoteRow& row : *rows) json["notes"].push_back(note_json(row));
  return made(json_text(json));
}

HttpAnswer create_note(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Result<ScanRow> row = world.scans.rows().find(call.id);
  if (!row.ok()) return refused(row.error());
  if (row->phase == ScanPhase::kRunning)
    return refused({ErrorCode::kBusy, fmt::format("scan {} is running: its surface may still move, "
                                                  "and notes are written when it has ended",
                                                  call.id)});
  return receive_note(world, call, true);
}

HttpAnswer change_note(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  return receive_note(world, call, false);
}

HttpAnswer remove_note(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const std::optional<std::int64_t> version = version_in(call.request.query);
  if (!version)
    return refused(invalid_note(
        "?version= must be the version of the note that is removed: a whole number from 1"));
  const Result<NoteOutcome> outcome = world.store.notes.remove(call.id, call.last_part, *version);
  if (!outcome.ok()) return refused(outcome.error());
  return outcome->is_done ? made(json_text({{"removed", call.last_part}}))
                          : changed_meanwhile(outcome->note);
}

}  // namespace hermite::server
