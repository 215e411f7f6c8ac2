#include "core/dataset/camera_file.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/dataset/sequence.h"
#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr std::size_t kMaxCameraFile_bytes = 64 << 10;
constexpr double kMinFrameRate_hz = 0.1, kMaxFrameRate_hz = 1000;
// Tolerance for the difference of R R^T from the identity: a calibration written with four digits
// passes, a mirrored or scaled one does not.
constexpr double kRotationTolerance = 1e-3;
constexpr const char* kAccelerometerKey = "camera_from_accelerometer";

struct KnownCamera {
  std::string_view name;       // --camera
  std::string_view mentioned;  // in folder names and comments
  Camera camera;
};

// The TUM benchmark's own calibration of its three Kinects (the images of the third are already
// undistorted); its depth files already contain the depth correction factors. ICL-NUIM publishes fy
// = -480: its reader reflects that world so that the camera frame is x right, y down, z forward.
// Redwood gives the factory calibration of its PrimeSense.
const KnownCamera kKnownCameras[] = {
    {"fr1",
     "freiburg1",
     {640, 480, 517.3, 516.5, 318.6, 255.3, 5000, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}}},
    {"fr2",
     "freiburg2",
     {640, 480, 520.9, 521.0, 325.1, 249.7, 5000, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}}},
    {"fr3", "freiburg3", {640, 480, 535.4, 539.2, 320.1, 247.6, 5000, {}}},
    {"icl-nuim", "", {640, 480, 481.2, 480.0, 319.5, 239.5, 5000, {}}},
    {"redwood", "", {640, 480, 525, 525, 319.5, 239.5, 1000, {}}},
};

Error key_error(const std::string& key, const std::string& message) {
  return {ErrorCode::kCorruptData, fmt::format("\"{}\" {}", key, message)};
}

Result<double> number_of(const nlohmann::json& object, const std::string& key) {
  const auto found = object.find(key);
  if (found == object.end()) return key_error(key, "is missing");
  if (!found->is_number()) return key_error(key, "is not a number");
  const double value = found->get<double>();
  if (!std::isfinite(value)) return key_error(key, "is not finite");
  return value;
}

Result<int> side_of(const nlohmann::json& object, const std::string& key) {
  const Result<double> value = number_of(object, key);
  if (!value.ok()) return value.error();
  if (*value != std::floor(*value) || *value < kMinImageSide_px || *value > kMaxImageSide_px)
    return key_error(key, fmt::format("must be a whole number of pixels from {} to {}",
                                      kMinImageSide_px, kMaxImageSide_px));
  return static_cast<int>(*value);
}

struct NamedNumber {
  const char* key;
  double* number;
};

// All of the numbers must be present.
Status read_numbers(const nlohmann::json& object, const std::vector<NamedNumber>& numbers) {
  for (const auto& [key, number] : numbers) {
    const Result<double> value = number_of(object, key);
    if (!value.ok()) return value.error();
    *number = *value;
  }
  return Done{};
}

// Reads those of the numbers that the object in `object[key]` has; all of them are optional, the
// object too.
Status read_some_numbers(const nlohmann::json& object, const std::string& key,
                         const std::vector<NamedNumber>& numbers) {
  if (!object.contains(key)) return Done{};
  const nlohmann::json& inner = object[key];
  if (!inner.is_object()) {
    std::string names;
    for (const NamedNumber& one : numbers)
      names += (names.empty() ? "" : ", ") + std::string(one.key);
    return key_error(key, "is not an object with " + names);
  }
  for (const NamedNumber& one : numbers)
    if (inner.contains(one.key))
      if (const Status status = read_numbers(inner, {one}); !status.ok())
        return in_context(fmt::format("\"{}\"", key), status.error());
  return Done{};
}

// Returns the distortion in `object[key]`; none if that is missing.
Result<Distortion> distortion_of(const nlohmann::json& object, const std::string& key) {
  Distortion distortion;
  const Status status = read_some_numbers(object, key,
                                          {{"k1", &distortion.k1},
                                           {"k2", &distortion.k2},
                                           {"p1", &distortion.p1},
                                           {"p2", &distortion.p2},
                                           {"k3", &distortion.k3}});
  if (!status.ok()) return status.error();
  return distortion;
}

// Returns the three rows of `object[key]`, of which the first three columns are a rotation.
Result<Eigen::MatrixXd> rows_of(const nlohmann::json& object, const std::string& key, int columns,
                                const char* shape) {
  const auto rows = object.find(key);
  const auto is_row = [columns](const nlohmann::json& row) {
    return row.is_array() && row.size() == static_cast<std::size_t>(columns) &&
           std::all_of(row.begin(), row.end(), [](const auto& value) { return value.is_number(); });
  };
  if (rows == object.end() || !rows->is_array() || rows->size() != 3 ||
      !std::all_of(rows->begin(), rows->end(), is_row))
    return key_error(key, fmt::format("must be three rows of {}", shape));
  Eigen::MatrixXd matrix(3, columns);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < columns; ++column)
      matrix(row, column) =
          (*rows)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  const double error =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance) || rotation.determinant() < 0)
    return key_error(key, "is no rotation in its left three columns, within " +
                              std::to_string(kRotationTolerance));
  return matrix;
}

Result<Rigid3> transform_of(const nlohmann::json& object, const std::string& key) {
  const Result<Eigen::MatrixXd> rows = rows_of(object, key, 4, "four numbers, [R | t in metres]");
  if (!rows.ok()) return rows.error();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRows<3>() = *rows;
  return rigid3_from_matrix(matrix);
}

Result<ColorCamera> color_camera_of(const nlohmann::json& object) {
  if (!object.is_object())
    return Error{ErrorCode::kCorruptData, "is not an object with fx, fy, cx, cy, color_from_depth"};
  ColorCamera color;
  const Status numbers = read_numbers(
      object, {{"fx", &color.fx}, {"fy", &color.fy}, {"cx", &color.cx}, {"cy", &color.cy}});
  if (!numbers.ok()) return numbers.error();
  const Result<Rigid3> color_from_depth = transform_of(object, "color_from_depth");
  if (!color_from_depth.ok()) return color_from_depth.error();
  color.color_from_depth = *color_from_depth;
  return color;
}

// Reads the optional keys of distortions and of a colour camera.
Status read_lenses(const nlohmann::json& object, CameraFile& file) {
  const Result<Distortion> of_color = distortion_of(object, "color_distortion"),
                           of_depth = distortion_of(object, "depth_distortion");
  if (!of_color.ok()) return of_color.error();
  if (!of_depth.ok()) return of_depth.error();
  const auto color_camera = object.find("color_camera");
  file.says_color_camera = color_camera != object.end();
  if (!file.says_color_camera || color_camera->is_null()) {
    if (object.contains("depth_distortion"))
      return key_error(
          "depth_distortion",
          "needs \"color_camera\": depth registered to colour has the lens of the colour image");
    file.camera.distortion = *of_color;
    return Done{};
  }
  const Result<ColorCamera> color = color_camera_of(*color_camera);
  if (!color.ok()) return in_context("\"color_camera\"", color.error());
  file.camera.distortion = *of_depth;
  file.camera.color = *color;
  file.camera.color->distortion = *of_color;
  return Done{};
}

}  // namespace

Result<CameraFile> parse_camera_json(const std::string& text) {
  const nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  if (!object.is_object()) return Error{ErrorCode::kCorruptData, "this is not one JSON object"};
  CameraFile file;
  const std::pair<const char*, int*> sides[] = {{"width", &file.camera.width},
                                                {"height", &file.camera.height}};
  for (const auto& [key, side] : sides) {
    const Result<int> value = side_of(object, key);
    if (!value.ok()) return value.error();
    *side = *value;
  }
  const Status numbers =
      read_numbers(object, {{"fx", &file.camera.fx},
                            {"fy", &file.camera.fy},
                            {"cx", &file.camera.cx},
                            {"cy", &file.camera.cy},
                            {"depth_units_per_metre", &file.camera.depth_units_per_metre}});
  if (!numbers.ok()) return numbers.error();
  if (const Status status = read_lenses(object, file); !status.ok()) return status.error();
  DepthCorrection& depth = file.camera.depth_correction;
  const Status of_depth = read_some_numbers(
      object, "depth_correction",
      {{"bend", &depth.bend}, {"inverse_offset_per_m", &depth.inverse_offset_per_m}});
  if (!of_depth.ok()) return of_depth.error();
  ImageTiming& timing = file.camera.timing;
  const Status of_timing = read_some_numbers(object, "timing",
                                             {{"depth_readout_s", &timing.depth_readout_s},
                                              {"color_readout_s", &timing.color_readout_s},
                                              {"color_delay_s", &timing.color_delay_s}});
  if (!of_timing.ok()) return of_timing.error();
  CameraDeviations& deviations = file.camera.deviations;
  const Status of_deviations = read_some_numbers(
      object, "standard_deviations",
      {{"bend", &deviations.bend}, {"focal", &deviations.focal}, {"k1", &deviations.k1}});
  if (!of_deviations.ok()) return of_deviations.error();
  if (const Status status = validate(file.camera); !status.ok()) return status.error();
  if (object.contains("frame_rate_hz")) {
    const Result<double> rate = number_of(object, "frame_rate_hz");
    if (!rate.ok()) return rate.error();
    if (*rate < kMinFrameRate_hz || *rate > kMaxFrameRate_hz)
      return key_error("frame_rate_hz", "must be from 0.1 to 1000");
    file.frame_rate_hz = *rate;
  }
  if (object.contains(kAccelerometerKey)) {
    const Result<Eigen::MatrixXd> axes = rows_of(object, kAccelerometerKey, 3, "three numbers");
    if (!axes.ok()) return axes.error();
    file.camera_from_accelerometer = *axes;
  }
  return file;
}

Result<CameraFile> read_camera_json(const std::string& path) {
  const Result<std::string> text = read_text_file(path, kMaxCameraFile_bytes);
  if (!text.ok()) return text.error();
  Result<CameraFile> file = parse_camera_json(*text);
  if (!file.ok()) return in_context(path, file.error());
  return file;
}

Result<std::optional<CameraBeside>> camera_beside(const std::string& path) {
  const std::filesystem::path in_folder = std::filesystem::path(path).parent_path() / "camera.json";
  for (const std::string& candidate : {path + ".camera.json", in_folder.string()}) {
    if (!is_file(candidate)) continue;
    Result<CameraFile> file = read_camera_json(candidate);
    if (!file.ok()) return file.error();
    return std::optional(
        CameraBeside{std::move(*file), std::filesystem::path(candidate).filename().string()});
  }
  return std::optional<CameraBeside>();
}

std::string format_camera_json(const CameraFile& file) {
  const Camera& camera = file.camera;
  const auto lens = [](const Distortion& d) {
    return nlohmann::ordered_json{
        {"k1", d.k1}, {"k2", d.k2}, {"p1", d.p1}, {"p2", d.p2}, {"k3", d.k3}};
  };
  nlohmann::ordered_json object{{"width", camera.width},
                                {"height", camera.height},
                                {"fx", camera.fx},
                                {"fy", camera.fy},
                                {"cx", camera.cx},
                                {"cy", camera.cy},
                                {"depth_units_per_metre", camera.depth_units_per_metre},
                                {"frame_rate_hz", file.frame_rate_hz}};
  object["color_distortion"] = lens(camera.color ? camera.color->distortion : camera.distortion);
  if (const DepthCorrection& depth = camera.depth_correction; depth != DepthCorrection{})
    object["depth_correction"] = {{"bend", depth.bend},
                                  {"inverse_offset_per_m", depth.inverse_offset_per_m}};
  if (const ImageTiming& timing = camera.timing; timing != ImageTiming{})
    object["timing"] = {{"depth_readout_s", timing.depth_readout_s},
                        {"color_readout_s", timing.color_readout_s},
                        {"color_delay_s", timing.color_delay_s}};
  if (const CameraDeviations& deviations = camera.deviations; deviations != CameraDeviations{})
    object["standard_deviations"] = {
        {"bend", deviations.bend}, {"focal", deviations.focal}, {"k1", deviations.k1}};
  object["color_camera"] = nullptr;
  if (camera.color) {
    const ColorCamera& color = *camera.color;
    const Eigen::Matrix4d matrix = color.color_from_depth.matrix();
    nlohmann::ordered_json rows;
    for (int row = 0; row < 3; ++row)
      rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
    object["depth_distortion"] = lens(camera.distortion);
    object["color_camera"] = {{"fx", color.fx},
                              {"fy", color.fy},
                              {"cx", color.cx},
                              {"cy", color.cy},
                              {"color_from_depth", rows}};
  }
  if (file.camera_from_accelerometer) {
    const Eigen::Matrix3d& axes = *file.camera_from_accelerometer;
    for (int row = 0; row < 3; ++row)
      object[kAccelerometerKey].push_back({axes(row, 0), axes(row, 1), axes(row, 2)});
  }
  return object.dump(2) + "\n";
}

std::optional<Camera> known_camera(std::string_view name) {
  for (const KnownCamera& known : kKnownCameras)
    if (known.name == name) return known.camera;
  return std::nullopt;
}

std::optional<Camera> camera_mentioned_in(std::string_view text) {
  for (const KnownCamera& known : kKnownCameras)
    if (!known.mentioned.empty() && text.find(known.mentioned) != std::string_view::npos)
      return known.camera;
  return std::nullopt;
}

Result<Camera> read_camera(const std::string& path_or_name) {
  if (const auto camera = known_camera(path_or_name)) return *camera;
  const Result<CameraFile> file = read_camera_json(path_or_name);
  if (file.ok()) return file->camera;
  if (file.error().code == ErrorCode::kNotFound)
    return Error{
        ErrorCode::kNotFound,
        fmt::format("camera \"{}\" is neither a file nor one of fr1, fr2, fr3, icl-nuim, redwood",
                    path_or_name)};
  return file.error();
}

}  // namespace hermite::dataset
