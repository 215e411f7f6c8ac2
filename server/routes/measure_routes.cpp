#include "server/routes/measure_routes.h"

#include <fmt/core.h>

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/printf_text.h"
#include "core/measure/measure.h"
#include "server/exports/result_sources.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/routes/gathered_body.h"
#include "server/routes/measuring_cache.h"
#include "server/routes/scan_routes.h"
#include "server/routes/turn.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMeasureRetry_ms = 1000;

std::atomic<int> measuring = 0;

struct NamedRequest {
  std::string name;  // only for a measurement to be saved
  measure::MeasureRequest measure;
};

Result<Eigen::Vector3d> triple_in(const Json& json, const std::string& field, const char* what) {
  const Error wrong{ErrorCode::kInvalidArgument,
                    fmt::format("{} must be three numbers, {}", field, what)};
  if (!json.is_array() || json.size() != 3) return wrong;
  Eigen::Vector3d triple;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!json[axis].is_number()) return wrong;
    triple[static_cast<Eigen::Index>(axis)] = json[axis].get<double>();
  }
  return triple;
}

Result<measure::MeasureRequest> measure_request_in(const Json& json) {
  measure::MeasureRequest request;
  const auto kind = json.find("kind");
  const std::optional<measure::MeasureKind> known =
      kind != json.end() && kind->is_string() ? measure::measure_kind_of(kind->get<std::string>())
                                              : std::nullopt;
  if (!known)
    return Error{ErrorCode::kInvalidArgument,
                 "kind must be one of " + measure::measure_kind_names()};
  request.kind = *known;
  const auto points = json.find("points");
  if (points == json.end() || !points->is_array() || points->size() > measure::kMostCorners)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("points must be a list of at most {} points", measure::kMostCorners)};
  for (std::size_t i = 0; i < points->size(); ++i) {
    const Result<Eigen::Vector3d> point =
        triple_in((*points)[i], fmt::format("points[{}]", i), "[x, y, z] in metres");
    if (!point.ok()) return point.error();
    request.points.push_back(*point);
  }
  if (const auto up = json.find("up"); up != json.end()) {
    const Result<Eigen::Vector3d> direction = triple_in(*up, "up", "[x, y, z] of a unit vector");
    if (!direction.ok()) return direction.error();
    request.up = *direction;
  }
  if (const Status status = measure::check_measure_request(request); !status.ok())
    return status.error();
  return request;
}

Result<NamedRequest> request_in(const std::string& body, bool is_kept) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object())
    return Error{ErrorCode::kInvalidArgument,
                 "the body must be a JSON object with \"kind\" and \"points\""};
  for (const auto& [field, value] : json.items())
    if (field != "kind" && field != "points" && field != "up" && !(is_kept && field == "name"))
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("the body may have {}\"kind\", \"points\" and \"up\", and nothing else",
                      is_kept ? "\"name\", " : "")};
  Result<measure::MeasureRequest> measure = measure_request_in(json);
  if (!measure.ok()) return measure.error();
  NamedRequest request{"", *std::move(measure)};
  if (!is_kept) return request;
  const auto name = json.find("name");
  if (name == json.end() || !name->is_string())
    return Error{ErrorCode::kInvalidArgument, "name is missing, or no text"};
  request.name = name->get<std::string>();
  if (const Status status = check_title("name", request.name); !status.ok()) return status.error();
  return request;
}

// Returns the quantity as stored in the row. The database ensures that its kind is valid.
measure::Quantity quantity_of(const MeasurementRow& row) {
  measure::Quantity quantity;
  quantity.kind = measure::measure_kind_of(row.kind).value_or(measure::MeasureKind::kDistance);
  quantity.value = row.value;
  quantity.half_width = row.half_width;
  return quantity;
}

Json json_of(const MeasurementRow& row) {
  const measure::Quantity quantity = quantity_of(row);
  Json json = {{"id", row.id},
               {"name", row.name},
               {"kind", row.kind},
               {"value", row.value},
               {"half_width", row.half_width},
               {"unit", row_of(quantity.kind).unit},
               {"confidence", measure::kConfidence},
               {"words", measure::text_of(quantity)},
               {"points", row.points},
               {"normals", row.normals}};
  if (row.up) json["up"] = *row.up;
  json["created_at"] = time_json(row.created_at_ms);
  return json;
}

// Returns a field of CSV. A text that a spreadsheet would take for a formula gets a leading
// apostrophe.
std::string csv_field(const std::string& text) {
  std::string field = "\"";
  if (!text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos)
    field += '\'';
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

// For example "0.1000 0.2000 1.9000; 1.2000 0.2000 2.1000".
std::string csv_points(const std::vector<MeasurementRow::Triple>& points) {
  std::string text;
  for (const auto& [x, y, z] : points)
    text += (text.empty() ? "" : "; ") + printf_text("%.4f %.4f %.4f", x, y, z);
  return text;
}

MeasurementRow::Triple array_of(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

MeasurementRow row_of(const measure::Measurement& measurement, const std::string& scan_id,
                      const std::string& name) {
  MeasurementRow row;
  row.id = new_scan_id();
  row.scan_id = scan_id;
  row.name = name;
  row.kind = row_of(measurement.quantity.kind).name;
  for (const measure::MeasuredPlace& place : measurement.places) {
    row.points.push_back(array_of(place.position_m));
    row.normals.push_back(array_of(place.normal));
  }
  if (measurement.up) row.up = array_of(*measurement.up);
  row.value = measurement.quantity.value;
  row.half_width = measurement.quantity.half_width;
  row.created_at_ms = unix_now_ms();
  return row;
}

// Receives the body of a request, and measures once it is complete.
class MeasureBody : public GatheredBody {
 public:
  MeasureBody(const HttpWorld& world, const Call& call, std::string surfels_name, bool is_kept)
      : GatheredBody(world, call), surfels_name_(std::move(surfels_name)), is_kept_(is_kept) {}

  void close(bool complete) override {
    if (!complete) return;
    const Result<NamedRequest> request = request_in(body_, is_kept_);
    if (!request.ok()) {
      measured_ = request.error();
      return;
    }
    name_ = request->name;
    const Turn turn(measuring, kMaxMeasuringAtOnce);
    is_turned_away_ = !turn.is_mine();
    if (turn.is_mine()) measured_ = measured(request->measure);
  }
  HttpAnswer answer() override {
    if (is_turned_away_)
      return wait_answer(503, "others are measuring: try again in a moment", kMeasureRetry_ms);
    if (!measured_.ok()) {
      // An invalid point must not be reported as 404.
      const Error& error = measured_.error();
      return error.code == ErrorCode::kNotFound
                 ? error_answer(400, {ErrorCode::kInvalidArgument, error.message})
                 : refused(error);
    }
    return is_kept_ ? kept() : made(measure::format_measurement_json(*measured_) + "\n");
  }

 private:
  Result<measure::Measurement> measured(const measure::MeasureRequest& request) const {
    const Result<std::shared_ptr<const measure::MeasuredResult>> result =
        world_.measuring.of(world_.scans.blobs(), scan_id_, surfels_name_);
    return result.ok() ? measure::measure(**result, request) : result.error();
  }
  HttpAnswer kept() const {
    const MeasurementRow row = row_of(*measured_, scan_id_, name_);
    if (const Status added = world_.store.measurements.add(row); !added.ok())
      return refused(added.error());
    return made(json_text(json_of(row)), 201);
  }

  const std::string surfels_name_;
  const bool is_kept_;
  std::string name_;
  bool is_turned_away_ = false;
  Result<measure::Measurement> measured_ =
      Error{ErrorCode::kInvalidArgument, "the body did not come whole"};
};

// Returns the name of the cloud to measure in, or why there is none.
Result<std::string> surfels_of(const HttpWorld& world, const std::string& scan_id) {
  const Result<ScanRow> row = world.scans.rows().find(scan_id);
  if (!row.ok()) return row.error();
  if (row->phase == ScanPhase::kRunning)
    return Error{
        ErrorCode::kBusy,
        fmt::format("scan {} is running: it can be measured in when it has ended", scan_id)};
  for (const char* needed : {kTrajectoryFile, kReportFile})
    if (!world.scans.ended_scans().size_of_result(scan_id, needed).ok())
      return Error{
          ErrorCode::kBusy,
          fmt::format("scan {} has no {}: nothing is known of the errors in it", scan_id, needed)};
  // In scans of earlier versions, cloud.ply has only the stable surfels.
  for (const char* name : {kSurfelsFile, kCloudFile})
    if (world.scans.ended_scans().size_of_result(scan_id, name).ok()) return std::string(name);
  return Error{ErrorCode::kBusy, fmt::format("scan {} has no points", scan_id)};
}

HttpAnswer receive_points(const HttpWorld& world, const Call& call, bool is_kept) {
  if (std::optional<HttpAnswer> no = wrong_size(call, kMaxMeasureBodyBytes)) return *std::move(no);
  Result<std::string> surfels = surfels_of(world, call.id);
  if (!surfels.ok()) return refused(surfels.error());
  return received_into(std::make_shared<MeasureBody>(world, call, *std::move(surfels), is_kept));
}

}  // namespace

HttpAnswer measure_scan(const HttpWorld& world, const Call& call) {
  return receive_points(world, call, false);
}

HttpAnswer keep_measurement(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  return receive_points(world, call, true);
}

HttpAnswer list_measurements(const HttpWorld& world, const Call& call) {
  if (const Result<ScanRow> row = world.scans.rows().find(call.id); !row.ok())
    return refused(row.error());
  const Result<std::vector<MeasurementRow>> rows = world.store.measurements.of_scan(call.id);
  if (!rows.ok()) return refused(rows.error());
  Json json = {{"measurements", Json::array()}};
  for (const MeasurementRow& row : *rows) json["measurements"].push_back(json_of(row));
  return made(json_text(json));
}

HttpAnswer send_measurements(const HttpWorld& world, const Call& call) {
  if (const Result<ScanRow> row = world.scans.rows().find(call.id); !row.ok())
    return refused(row.error());
  const Result<std::vector<MeasurementRow>> rows = world.store.measurements.of_scan(call.id);
  if (!rows.ok()) return refused(rows.error());
  HttpAnswer answer;
  answer.content_type = "text/csv; charset=utf-8";
  answer.download_name = call.id + "-measurements.csv";
  answer.body = "name,kind,value,unit,half_width_95,points_m\r\n";
  for (const MeasurementRow& row : *rows)
    answer.body +=
        fmt::format("{},{},{:.4f},{},{:.4f},{}\r\n", csv_field(row.name), row.kind, row.value,
                    row_of(quantity_of(row).kind).unit, row.half_width, csv_points(row.points));
  return answer;
}

HttpAnswer remove_measurement(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Status removed = world.store.measurements.remove(call.id, call.last_part);
  return removed.ok() ? made(json_text({{"removed", call.last_part}})) : refused(removed.error());
}

}  // namespace hermite::server
