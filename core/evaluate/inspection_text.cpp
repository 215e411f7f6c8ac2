// Formats an inspection as text and as JSON.
#include <fmt/core.h>

#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/evaluate/inspection.h"

namespace hermite::evaluate {
namespace {

// Appends a line of the text: the label and the formatted rest.
__attribute__((format(printf, 3, 4))) void add_line(std::string& text, const char* label,
                                                    const char* format, ...) {
  char rest[400];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(rest, sizeof rest, format, values);
  va_end(values);
  std::string line = label;
  line.resize(14, ' ');
  text += line + rest + "\n";
}

void add_camera_lines(std::string& text, const Inspection& found) {
  const Camera& camera = found.camera;
  add_line(text, "camera", "%dx%d, fx %.6g, fy %.6g, cx %.6g, cy %.6g (%s)", camera.width,
           camera.height, camera.fx, camera.fy, camera.cx, camera.cy, found.camera_source.c_str());
  if (camera.color) {
    add_line(text, "colour",
             "by a camera of its own: fx %.6g, fy %.6g, cx %.6g, cy %.6g, %.1f mm away",
             camera.color->fx, camera.color->fy, camera.color->cx, camera.color->cy,
             1000 * camera.color->color_from_depth.translation.norm());
  } else if (const auto& fit = found.registration) {
    add_line(text, "registration",
             "depth edges lie at most %.2f times better on the image when moved: %s", fit->gain,
             fit->is_doubtful() ? "doubtful" : "registered, as far as one can see");
  } else {
    add_line(text, "registration", "taken to be registered; too few depth edges to tell");
  }
}

void add_depth_lines(std::string& text, const Inspection& found) {
  const double units = found.camera.depth_units_per_metre;
  add_line(text, "depth unit", "%.6g a metre; likely %.6g", units, found.unit.units_per_metre);
  text += std::string(14, ' ') + found.unit.reason + "\n";
  add_line(
      text, "depth",
      "%.1f %% of the pixels, %.2f to %.2f m (1 to 99 %%), median %.2f m; %lld distinct values",
      100 * found.depth.valid_share, found.depth.nearest / units, found.depth.farthest / units,
      found.depth.median / units, static_cast<long long>(found.depth.distinct_values));
}

nlohmann::ordered_json camera_json(const Inspection& found) {
  const Camera& camera = found.camera;
  nlohmann::ordered_json json{{"width", camera.width},
                              {"height", camera.height},
                              {"fx", camera.fx},
                              {"fy", camera.fy},
                              {"cx", camera.cx},
                              {"cy", camera.cy},
                              {"depth_units_per_metre", camera.depth_units_per_metre},
                              {"has_color_camera", camera.color.has_value()},
                              {"source", found.camera_source}};
  return json;
}

nlohmann::ordered_json depth_json(const Inspection& found) {
  const double units = found.camera.depth_units_per_metre;
  return {{"valid_share", found.depth.valid_share},
          {"nearest_m", found.depth.nearest / units},
          {"median_m", found.depth.median / units},
          {"farthest_m", found.depth.farthest / units},
          {"distinct_values", found.depth.distinct_values},
          {"likely_units_per_metre", found.unit.units_per_metre},
          {"unit_reason", found.unit.reason},
          {"unit_is_doubtful", found.unit.is_doubtful}};
}

}  // namespace

std::string inspection_text(const Inspection& found) {
  std::string text = found.name + "\n";
  text += fmt::format("format        {}: {}\n", found.format, found.format_reason);
  add_line(text, "frames", "%lld in %.2f s, %.4g a second (stated %.4g)",
           static_cast<long long>(found.frame_count), found.duration_s, found.measured_rate_hz,
           found.stated_rate_hz);
  for (const TimeGap& gap : found.longest_gaps)
    add_line(text, "gap", "%.3f s after frame %lld", gap.length_s,
             static_cast<long long>(gap.after_frame));
  add_line(text, "size", "%.1f MB", static_cast<double>(found.size_bytes) * 1e-6);
  add_camera_lines(text, found);
  add_depth_lines(text, found);
  if (found.truth.pose_count == 0) {
    add_line(text, "ground truth", "none");
  } else {
    add_line(text, "ground truth", "%lld poses, %lld frames have one, %.2f m long",
             static_cast<long long>(found.truth.pose_count),
             static_cast<long long>(found.truth.frames_with_pose), found.truth.path_m);
  }
  add_line(text, "looked at", "%lld frames, %lld unreadable",
           static_cast<long long>(found.frames_looked_at),
           static_cast<long long>(found.unreadable_count));
  for (const std::string& doubt : found.doubts) text += fmt::format("doubt         {}\n", doubt);
  if (found.doubts.empty()) text += "no doubts\n";
  return text;
}

std::string inspection_json(const Inspection& found) {
  nlohmann::ordered_json gaps = nlohmann::ordered_json::array();
  for (const TimeGap& gap : found.longest_gaps)
    gaps.push_back({{"after_frame", gap.after_frame}, {"length_s", gap.length_s}});
  nlohmann::ordered_json json{{"name", found.name},
                              {"format", found.format},
                              {"format_reason", found.format_reason},
                              {"frame_count", found.frame_count},
                              {"duration_s", found.duration_s},
                              {"stated_rate_hz", found.stated_rate_hz},
                              {"measured_rate_hz", found.measured_rate_hz},
                              {"gap_count", found.gap_count},
                              {"longest_gaps", gaps},
                              {"size_bytes", found.size_bytes},
                              {"frames_looked_at", found.frames_looked_at},
                              {"unreadable_count", found.unreadable_count},
                              {"camera", camera_json(found)},
                              {"depth", depth_json(found)},
                              {"registration", nullptr},
                              {"groundtruth", nullptr},
                              {"doubts", found.doubts}};
  if (const auto& fit = found.registration)
    json["registration"] = {{"scale", fit->scale},       {"dx_px", fit->dx_px},
                            {"dy_px", fit->dy_px},       {"gain", fit->gain},
                            {"worst_px", fit->worst_px}, {"is_doubtful", fit->is_doubtful()}};
  if (found.truth.pose_count > 0)
    json["groundtruth"] = {{"pose_count", found.truth.pose_count},
                           {"frames_with_pose", found.truth.frames_with_pose},
                           {"path_m", found.truth.path_m},
                           {"fastest_m_per_s", found.truth.fastest_m_per_s}};
  // File names need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace hermite::evaluate
