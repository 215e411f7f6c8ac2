#include "server/routes/measure_routes.h"

#include <array>
#include <atomic>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/printf_text.h"
#include "core/measure/measure.h"
#include "server/operations/json_text.h"
#include "server/operations/json_time.h"
#include "server/routes/scan_routes.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxMeasureBodyBytes = 4 * 1024;
// A day of 30 poses a second is 250 MB, and no scan has as many.
constexpr std::size_t kMaxTrajectoryBytes = std::size_t{64} << 20, kMaxReportBytes = std::size_t{1} << 20;

constexpr std::int64_t kMeasureRetry_ms = 1000;

// One of those that may measure at once, while it lives.
class MeasuringTurn {
 public:
  bool is_mine() const { return before_ < kMaxMeasuringAtOnce; }
  MeasuringTurn() : before_(under_way_.fetch_add(1)) {}
  ~MeasuringTurn() { under_way_.fetch_sub(1); }
  MeasuringTurn(const MeasuringTurn&) = delete;
  MeasuringTurn& operator=(const MeasuringTurn&) = delete;

 private:
  inline static std::atomic<int> under_way_ = 0;
  const int before_;
};

struct MeasureRequest {
  std::string name;  // of one that is kept
  Eigen::Vector3d from, to;
};

Result<Eigen::Vector3d> point_in(const Json& json, const char* field) {
  const Error wrong{ErrorCode::kInvalidArgument, std::string(field) + " must be three numbers, [x, y, z] in metres"};
  const auto found = json.find(field);
  if (found == json.end() || !found->is_array() || found->size() != 3) return wrong;
  Eigen::Vector3d point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(*found)[axis].is_number()) return wrong;
    point[static_cast<Eigen::Index>(axis)] = (*found)[axis].get<double>();
  }
  return point;
}

Result<MeasureRequest> request_in(const std::string& body, bool is_kept) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || json.size() != (is_kept ? 3u : 2u))
    return Error{ErrorCode::kInvalidArgument, std::string("the body must be a JSON object with ") + (is_kept ? "\"name\", " : "") +
                                                  "\"from\" and \"to\", and nothing else"};
  const Result<Eigen::Vector3d> from = point_in(json, "from"), to = point_in(json, "to");
  if (!from.ok()) return from.error();
  if (!to.ok()) return to.error();
  MeasureRequest request{"", *from, *to};
  if (!is_kept) return request;
  const auto name = json.find("name");
  if (name == json.end() || !name->is_string()) return Error{ErrorCode::kInvalidArgument, "name is missing, or no text"};
  request.name = name->get<std::string>();
  if (const Status status = check_title("name", request.name); !status.ok()) return status.error();
  return request;
}

Json json_of(const MeasurementRow& row) {
  Distance distance;
  distance.distance_m = row.distance_m;
  distance.half_width_m = row.half_width_m;
  return {{"id", row.id},
          {"name", row.name},
          {"distance_m", row.distance_m},
          {"half_width_m", row.half_width_m},
          {"confidence", 0.95},
          {"words", words_of(distance)},
          {"from", row.from},
          {"to", row.to},
          {"created_at", time_json(row.created_at_ms)}};
}

// A field of CSV. What a spreadsheet would take for a formula begins with an apostrophe.
std::string csv_field(const std::string& text) {
  std::string field = "\"";
  if (!text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos) field += '\'';
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

std::array<double, 3> array_of(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

// The request's body on its way, and what is measured when all of it is there.
class MeasureBody : public BodySink {
 public:
  MeasureBody(const HttpWorld& world, const Call& call, std::string surfels_name, bool is_kept)
      : world_(world), scan_id_(call.id), grant_(call.grant), surfels_name_(std::move(surfels_name)), is_kept_(is_kept) {}

  Status write(std::string_view piece) override {
    body_ += piece;
    return Done{};
  }
  void close(bool complete) override {
    if (!complete) return;
    const Result<MeasureRequest> request = request_in(body_, is_kept_);
    if (!request.ok()) {
      measured_ = request.error();
      return;
    }
    name_ = request->name;
    const MeasuringTurn turn;
    is_turned_away_ = !turn.is_mine();
    if (turn.is_mine()) measured_ = measure(*request);
  }
  bool wanted() const override { return world_.gate.holds(grant_, unix_now_ms()); }
  void on_unwanted(std::function<void()>) override {}
  HttpAnswer answer() override {
    if (is_turned_away_) return wait_answer(503, "others are measuring: try again in a moment", kMeasureRetry_ms);
    if (!measured_.ok()) {
      // What is wrong with a point is not that there is nothing at the path.
      const Error& error = measured_.error();
      return error.code == ErrorCode::kNotFound ? error_answer(400, {ErrorCode::kInvalidArgument, error.message}) : refused(error);
    }
    return is_kept_ ? kept() : made(format_measurement_json(*measured_) + "\n");
  }

 private:
  Result<Measurement> measure(const MeasureRequest& request) const {
    Blobs& blobs = world_.scans.blobs();
    const Result<std::string> trajectory = read_blob(blobs, scan_id_, "trajectory.txt", kMaxTrajectoryBytes);
    const Result<std::string> report = read_blob(blobs, scan_id_, "report.json", kMaxReportBytes);
    for (const Result<std::string>* text : {&trajectory, &report})
      if (!text->ok()) return text->error();
    Result<MapKnowledge> map = map_knowledge_of(*trajectory, *report);
    if (!map.ok()) return map.error();
    const ReadPart surfels = [&](std::uint64_t offset, std::size_t max_bytes) {
      return blobs.read(scan_id_, surfels_name_, offset, max_bytes);
    };
    return measure_distance({surfels, *std::move(map)}, request.from, request.to);
  }
  HttpAnswer kept() const {
    const MeasurementRow row{new_scan_id(),
                             scan_id_,
                             name_,
                             array_of(measured_->from.position_m),
                             array_of(measured_->to.position_m),
                             measured_->distance.distance_m,
                             measured_->distance.half_width_m,
                             unix_now_ms()};
    if (const Status added = world_.store.add_measurement(row); !added.ok()) return refused(added.error());
    return made(json_text(json_of(row)), 201);
  }

  const HttpWorld& world_;
  const std::string scan_id_;
  const Grant grant_;
  const std::string surfels_name_;
  const bool is_kept_;
  std::string body_, name_;
  bool is_turned_away_ = false;
  Result<Measurement> measured_ = Error{ErrorCode::kInvalidArgument, "the body did not come whole"};
};

// What there is to measure in, or why nothing.
Result<std::string> surfels_of(const HttpWorld& world, const std::string& scan_id) {
  const Result<ScanRow> row = world.scans.find(scan_id);
  if (!row.ok()) return row.error();
  if (row->phase == ScanPhase::kRunning)
    return Error{ErrorCode::kBusy, "scan " + scan_id + " is running: it can be measured in when it has ended"};
  for (const char* needed : {"trajectory.txt", "report.json"})
    if (!world.scans.size_of_result(scan_id, needed).ok())
      return Error{ErrorCode::kBusy, "scan " + scan_id + " has no " + needed + ": nothing is known of the errors in it"};
  // Scans of earlier versions have the stable surfels alone.
  for (const char* name : {"surfels.ply", "cloud.ply"})
    if (world.scans.size_of_result(scan_id, name).ok()) return std::string(name);
  return Error{ErrorCode::kBusy, "scan " + scan_id + " has no points"};
}

HttpAnswer receive_points(const HttpWorld& world, const Call& call, bool is_kept) {
  if (call.request.body_bytes == 0 || call.request.body_bytes > kMaxMeasureBodyBytes)
    return error_answer(call.request.body_bytes == 0 ? 400 : 413,
                        {ErrorCode::kInvalidArgument, "the body has " + std::to_string(call.request.body_bytes) +
                                                          " bytes, allowed are 1 to " + std::to_string(kMaxMeasureBodyBytes)});
  Result<std::string> surfels = surfels_of(world, call.id);
  if (!surfels.ok()) return refused(surfels.error());
  HttpAnswer answer;
  answer.body_sink = std::make_shared<MeasureBody>(world, call, *std::move(surfels), is_kept);
  return answer;
}

}  // namespace

HttpAnswer measure_scan(const HttpWorld& world, const Call& call) { return receive_points(world, call, false); }

HttpAnswer keep_measurement(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  return receive_points(world, call, true);
}

HttpAnswer list_measurements(const HttpWorld& world, const Call& call) {
  if (const Result<ScanRow> row = world.scans.find(call.id); !row.ok()) return refused(row.error());
  const Result<std::vector<MeasurementRow>> rows = world.store.list_measurements(call.id);
  if (!rows.ok()) return refused(rows.error());
  Json json = {{"measurements", Json::array()}};
  for (const MeasurementRow& row : *rows) json["measurements"].push_back(json_of(row));
  return made(json_text(json));
}

HttpAnswer send_measurements(const HttpWorld& world, const Call& call) {
  if (const Result<ScanRow> row = world.scans.find(call.id); !row.ok()) return refused(row.error());
  const Result<std::vector<MeasurementRow>> rows = world.store.list_measurements(call.id);
  if (!rows.ok()) return refused(rows.error());
  HttpAnswer answer;
  answer.content_type = "text/csv; charset=utf-8";
  answer.download_name = call.id + "-measurements.csv";
  answer.body = "name,distance_m,half_width_95_m,from_x_m,from_y_m,from_z_m,to_x_m,to_y_m,to_z_m\r\n";
  for (const MeasurementRow& row : *rows)
    answer.body += csv_field(row.name) + printf_text(",%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\r\n", row.distance_m, row.half_width_m,
                                                     row.from[0], row.from[1], row.from[2], row.to[0], row.to[1], row.to[2]);
  return answer;
}

HttpAnswer remove_measurement(const HttpWorld& world, const Call& call) {
  if (std::optional<HttpAnswer> no = keep_out(world, call)) return *std::move(no);
  const Status removed = world.store.remove_measurement(call.id, call.last_part);
  return removed.ok() ? made(json_text({{"removed", call.last_part}})) : refused(removed.error());
}

}  // namespace hermite
