#include "core/pipeline/options.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <functional>
#include <variant>

namespace hermite::pipeline {

namespace {

using Field = std::variant<double*, int*, bool*>;

struct Row {
  const char* key;
  std::function<Field(Options&)> field;
  double low, high;  // of numbers, inclusive
  const char* description;
};

template <class Group, class Value>
std::function<Field(Options&)> member(Group Options::*group, Value Group::*value) {
  return [group, value](Options& options) -> Field { return &(options.*group.*value); };
}

std::vector<Row> frame_rows() {
  using F = frame::FrameOptions;
  const auto f = [](auto value) { return member(&Options::frame, value); };
  return {
      {"frame.depth_min_m", f(&F::depth_min_m), 0.05, 5, "nearer measurements are ignored [m]"},
      {"frame.depth_max_m", f(&F::depth_max_m), 0.5, 20, "farther measurements are ignored [m]"},
      {"frame.sampling", f(&F::sampling), 1, 2,
       "1: all pixels; 2: a quarter of the pixels of images beyond 320x240, a different one per "
       "frame"},
      {"frame.bilateral_sigma_space_px", f(&F::bilateral_sigma_space_px), 0.4, 6,
       "bilateral filter: spatial width for independent noise [px]"},
      {"frame.bilateral_correlated_space_px", f(&F::bilateral_correlated_space_px), 0.4, 6,
       "bilateral filter: spatial width for noise as correlated as a Kinect's [px]"},
      {"frame.bilateral_noise_sigmas", f(&F::bilateral_noise_sigmas), 0.01, 100,
       "bilateral filter: width in depth, in standard deviations of the noise"},
      {"frame.measure_noise", f(&F::measure_noise), 0, 1,
       "adapt the filter to the measured correlation of noise, or assume independent noise"},
      {"frame.noise_floor_m", f(&F::noise_floor_m), 1e-5, 0.1,
       "standard deviation of depth at 0.4 m [m]"},
      {"frame.noise_growth_per_m", f(&F::noise_growth_per_m), 0, 0.1,
       "growth of that deviation with the square of the distance beyond 0.4 m [1/m]"},
      {"frame.support_radius_scale", f(&F::support_radius_scale), 1, 10,
       "support radius of a kernel in diagonals of sampled pixels"},
      {"frame.depth_gate_m", f(&F::depth_gate_m), 0.01, 1,
       "pixels farther apart in depth are on different surfaces [m]"},
      {"frame.curvature_limit_per_m", f(&F::curvature_limit_per_m), 10, 1e4,
       "larger curvatures are rejected [1/m]"},
      {"frame.hrbf_confidence", f(&F::hrbf_confidence), 0, 1,
       "confidence from the HRBF gradient times lens distortion, or distortion only"},
      {"frame.confidence_epsilon", f(&F::confidence_epsilon), 1, 1e5,
       "HRBF confidence exp(-epsilon / sqrt(gradient))"},
      {"frame.project_to_surface", f(&F::project_to_surface), 0, 1,
       "move vertices onto the frame's own HRBF surface"},
      {"frame.correct_camera", f(&F::correct_camera), 0, 1,
       "correct a camera whose focal length, distortion, depth bend or timing of rows turns out to "
       "be off, and reprocess the scan"},
  };
}

std::vector<Row> track_rows() {
  using T = track::TrackOptions;
  const auto t = [](auto value) { return member(&Options::track, value); };
  return {
      {"track.rotation_prealignment", t(&T::rotation_prealignment), 0, 1,
       "start from the rotation that aligns the grey images"},
      {"track.constant_velocity", t(&T::constant_velocity), 0, 1,
       "also start from the last motion; the guess that fits best wins"},
      {"track.geometric_weight", t(&T::geometric_weight), 0, 1e9,
       "weight of the geometric relative to the photometric term"},
      {"track.discount_normal_noise", t(&T::discount_normal_noise), 0, 1,
       "use geometry only along motions that it observes beyond the noise of normals, or along "
       "all"},
      {"track.photometric_sigma", t(&T::photometric_sigma), 1, 1e4,
       "grey-value difference that weighs as much as 1 / sqrt(geometric_weight) metres"},
      {"track.photometric_gate", t(&T::photometric_gate), 0.5, 1e3,
       "pairs farther from the surface have no photometric term [robust scales]"},
      {"track.mature_confidence", t(&T::mature_confidence), 1e-6, 1,
       "tracking confidence below which a surfel's photometric weight decreases"},
      {"track.distance_gate_m", t(&T::distance_gate_m), 0.005, 1,
       "farther points do not correspond [m]"},
      {"track.normal_gate_deg", t(&T::normal_gate_deg), 1, 90,
       "points whose normals differ by more do not correspond [deg]"},
      {"track.photometric_depth_gate_m", t(&T::photometric_depth_gate_m), 0.005, 1,
       "photometric pairs agree in depth to within this [m]"},
      {"track.dissimilarity_search", t(&T::dissimilarity_search), 0, 1,
       "5x5 dissimilarity search, or projective association only"},
      {"track.max_iterations_coarse", t(&T::max_iterations_coarse), 1, 100,
       "Gauss-Newton steps at the coarsest of three levels"},
      {"track.max_iterations_middle", t(&T::max_iterations_middle), 1, 100,
       "Gauss-Newton steps at the middle level"},
      {"track.max_iterations_fine", t(&T::max_iterations_fine), 1, 100,
       "Gauss-Newton steps at the finest level"},
      {"track.max_step_m", t(&T::max_step_m), 0.01, 10,
       "a larger motion between frames is rejected [m]"},
      {"track.min_surface_ratio", t(&T::min_surface_ratio), 0, 1,
       "the camera is lost when a smaller share of the pixels has depth"},
      {"track.min_agreement", t(&T::min_agreement), 0, 1,
       "the camera is lost when a smaller share of the known surface is where it should be"},
      {"track.min_overlap", t(&T::min_overlap), 0, 1,
       "the camera is lost when a smaller share of the view is in the map"},
      {"track.min_correlation", t(&T::min_correlation), -1, 1,
       "the camera is lost when the colour image correlates less with the model's"},
      {"track.object", t(&T::object), 0, 1,
       "scan an object that moves in front of the camera and ignore the rest, or ignore what "
       "moves"},
  };
}

std::vector<Row> map_rows() {
  using M = map::MapOptions;
  const auto m = [](auto value) { return member(&Options::map, value); };
  return {
      {"map.stable_confidence", m(&M::stable_confidence), 0, 100,
       "surfels of at least this confidence are stable"},
      {"map.max_confidence", m(&M::max_confidence), 1, 1e6,
       "upper limit of confidence, so that old surfels can still move"},
      {"map.hrbf_prediction", m(&M::hrbf_prediction), 0, 1,
       "predict by HRBF ray intersection, or by surfel splatting"},
      {"map.correct_bias", m(&M::correct_bias), 0, 1,
       "remove the outward bias of the zero set on curved surfaces"},
      {"map.window", m(&M::window), 5, 9, "side length of the window of kernels (5, 7 or 9) [px]"},
      {"map.curvature_weight", m(&M::curvature_weight), 0, 1,
       "give curved surface more weight in tracking, as the paper does"},
      {"map.curvature_lambda_per_m", m(&M::curvature_lambda_per_m), 0, 1e3,
       "curvature at which that weight rises [1/m]"},
      {"map.confidence_scale", m(&M::confidence_scale), 0, 1,
       "share of surfel confidence in the tracking weight"},
      {"map.min_support", m(&M::min_support), 1, 49, "kernels that must support a predicted point"},
      {"map.max_iterations", m(&M::max_iterations), 1, 50,
       "steps along the ray before the solution is judged and refined once more"},
      {"map.fill_in_below", m(&M::fill_in_below), 0, 1.01,
       "coverage below which the frame's own surface completes the prediction"},
      {"map.fuse_depth_gate_m", m(&M::fuse_depth_gate_m), 0.005, 1,
       "a measurement and its surfel agree to within this along the ray [m]"},
      {"map.fuse_normal_gate_rad", m(&M::fuse_normal_gate_rad), 0.01, 3.2,
       "a measurement and its surfel agree to within this in the normal [rad]"},
      {"map.fuse_surface", m(&M::fuse_surface), 0, 1,
       "fuse points of the HRBF surface, or raw depth"},
      {"map.weigh_by_radius", m(&M::weigh_by_radius), 0, 1,
       "in fusion, weight finer views of a surfel more, by the square of the radius"},
      {"map.clean_interval_frames", m(&M::clean_interval_frames), 1, 100,
       "every surfel is examined for removal once per this many frames"},
      {"map.max_unstable_age_frames", m(&M::max_unstable_age_frames), 1, 1e6,
       "unstable surfels not seen for longer are removed [frames]"},
      {"map.redundancy_depth_m", m(&M::redundancy_depth_m), 0.001, 0.1,
       "surfels this close in front of an older surface are redundant [m]"},
      {"map.gpu_memory_mb", m(&M::gpu_memory_mb), 0, 1e6,
       "device memory of the scan; inactive submaps move to host memory; 0: no limit [MB]"},
  };
}

std::vector<Row> adjust_rows() {
  using A = adjust::AdjustOptions;
  const auto a = [](auto value) { return member(&Options::adjust, value); };
  return {
      {"adjust.local_bundle_adjustment", a(&A::local_bundle_adjustment), 0, 1,
       "align neighbouring submaps by the landmarks they share"},
      {"adjust.global_bundle_adjustment", a(&A::global_bundle_adjustment), 0, 1,
       "close loops, relocalise a lost camera, join parts of the map, and align all submaps"},
      {"adjust.depth_links", a(&A::depth_links), 0, 1,
       "if a loop was closed, also align submaps by their keyframes' depth after the last frame"},
      {"adjust.submap_distance_m", a(&A::submap_distance_m), 0.05, 10,
       "distance from the last submap at which a new one is opened [m]"},
      {"adjust.submap_turn_deg", a(&A::submap_turn_deg), 2, 90,
       "rotation from the last submap at which a new one is opened [deg]"},
      {"adjust.keyframe_distance_m", a(&A::keyframe_distance_m), 0.02, 10,
       "distance from all other keyframes at which a new one is taken [m]"},
      {"adjust.keyframe_turn_deg", a(&A::keyframe_turn_deg), 1, 90,
       "rotation from all near keyframes at which a new one is taken [deg]"},
      {"adjust.active_path_m", a(&A::active_path_m), 0.3, 1000,
       "submaps farther away along the path are verified before they are used again [m]"},
      {"adjust.new_part_after_frames", a(&A::new_part_after_frames), 1, 1e6,
       "a camera that sees enough and is lost for this long starts a new part of the map [frames]"},
  };
}

const std::vector<Row>& rows() {
  static const std::vector<Row> table = [] {
    std::vector<Row> all;
    for (const std::vector<Row>& group : {frame_rows(), track_rows(), map_rows(), adjust_rows()})
      all.insert(all.end(), group.begin(), group.end());
    all.push_back({"output.unstable", [](Options& o) -> Field { return &o.output_unstable; }, 0, 1,
                   "also export surfels that are not stable"});
    return all;
  }();
  return table;
}

// Returns the shortest text that reads back as the same number.
std::string to_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string text_of(const Field& field) {
  if (const auto* flag = std::get_if<bool*>(&field)) return **flag ? "true" : "false";
  if (const auto* number = std::get_if<int*>(&field)) return std::to_string(**number);
  return to_text(*std::get<double*>(field));
}

bool parse_number(const std::string& text, double& number) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end;
}

}  // namespace

std::vector<Setting> list_settings(const Options& options) {
  Options copy = options;
  std::vector<Setting> settings;
  for (const Row& row : rows())
    settings.push_back({row.key, text_of(row.field(copy)), row.description});
  return settings;
}

double least_output_confidence(const Options& options) {
  return options.output_unstable ? 1e-6 : options.map.stable_confidence;
}

Status apply_setting(Options& options, const std::string& key, const std::string& value) {
  for (const Row& row : rows()) {
    if (key != row.key) continue;
    const Field field = row.field(options);
    if (auto* const* flag = std::get_if<bool*>(&field)) {
      if (value != "true" && value != "false" && value != "1" && value != "0")
        return Error{ErrorCode::kInvalidArgument,
                     fmt::format("setting {} is '{}', allowed is true or false", key, value)};
      **flag = value == "true" || value == "1";
      return Done{};
    }
    double number = 0;
    const bool whole = std::holds_alternative<int*>(field);
    // Written so that NaN fails too.
    if (!parse_number(value, number) || !(number >= row.low && number <= row.high) ||
        (whole && number != static_cast<int>(number)))
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("setting {} is '{}', allowed is {}{} to {}", key, value,
                      whole ? "a whole number " : "", to_text(row.low), to_text(row.high))};
    if (key == "map.window" && static_cast<int>(number) % 2 == 0)
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format(
              "setting {} is '{}', allowed is 5, 7 or 9, since a window has a central pixel", key,
              value)};
    if (whole)
      *std::get<int*>(field) = static_cast<int>(number);
    else
      *std::get<double*>(field) = number;
    return Done{};
  }
  return Error{
      ErrorCode::kNotFound,
      fmt::format("there is no setting '{}'; `hermite reconstruct --help` lists them", key)};
}

}  // namespace hermite::pipeline
