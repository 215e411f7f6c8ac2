#include "server/capture/preflight.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/printf_text.h"
#include "core/evaluate/depth_doubts.h"

namespace hermite::client {
namespace {

constexpr double kGap = 1.5;            // in median steps: a frame is missing
constexpr double kRateTolerance = 0.2;  // relative to the nominal rate
// Relative to the time passed on this machine: USB delivers in bursts.
constexpr double kClockTolerance = 0.25;
constexpr double kShortestToCompare_s = 0.5;
// Structured light measures nothing nearer than 0.4 to 0.5 m.
constexpr double kTooNear_m = 0.6;
// Mean grey out of 255: beyond these, ORB finds hardly any corners.
constexpr double kDark = 35, kBright = 225;
constexpr int kLuma_r = 299, kLuma_g = 587, kLuma_b = 114;  // in thousandths, the weights of JPEG

// Samples every seventh pixel, since 7 divides no usual row length.
double mean_grey(const ColorImage& color) {
  std::int64_t sum = 0, count = 0;
  for (std::size_t i = 0; i < color.pixels.size(); i += 7, ++count)
    sum += kLuma_r * color.pixels[i].r + kLuma_g * color.pixels[i].g + kLuma_b * color.pixels[i].b;
  return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) / 1000 : 0;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Preflight::Preflight(const CameraDescription& camera) : camera_(camera) {}

void Preflight::add(const frame::RgbdFrame& frame, double host_s, const LeftOut& left_out) {
  frames_.push_back({frame.timestamp_s, host_s, mean_grey(frame.color)});
  left_out_ = left_out;
  depth_.add(frame.depth);
  if (!camera_.camera.color) registration_.add(frame, camera_.camera.depth_units_per_metre);
}

double Preflight::rate_hz() const {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < frames_.size(); ++i)
    steps_s.push_back(frames_[i].time_s - frames_[i - 1].time_s);
  const double step_s = median(std::move(steps_s));
  return step_s > 0 ? 1 / step_s : 0;
}

void Preflight::add_time_doubts(std::vector<std::string>& doubts) const {
  const double rate = rate_hz();
  if (rate == 0) return;
  if (std::abs(rate / camera_.frame_rate_hz - 1) > kRateTolerance)
    doubts.push_back(
        fmt::format("the time stamps say {} frames a second, the camera should give {}: too dark a "
                    "room makes some cameras slower, a shared USB port all",
                    printf_text("%.3g", rate), printf_text("%.3g", camera_.frame_rate_hz)));
  const auto is_gap = [&](const Seen& before, const Seen& after) {
    return (after.time_s - before.time_s) * rate > kGap;
  };
  int gap_count = 0;
  for (std::size_t i = 1; i < frames_.size(); ++i)
    gap_count += is_gap(frames_[i - 1], frames_[i]) ? 1 : 0;
  if (gap_count > 0)
    doubts.push_back(fmt::format(
        "frames are missing at {} places: this computer or its USB is too slow", gap_count));
  const double camera_s = frames_.back().time_s - frames_.front().time_s,
               host_s = frames_.back().host_s - frames_.front().host_s;
  if (host_s >= kShortestToCompare_s && std::abs(camera_s / host_s - 1) > kClockTolerance)
    doubts.push_back(
        fmt::format("the time stamps do not fit the clock: they say {} while {} went by",
                    printf_text("%.2f s", camera_s), printf_text("%.2f s", host_s)));
  if (left_out_.unpaired > 0)
    doubts.push_back(
        fmt::format("{} depth images had no colour image at the same time and were left out",
                    left_out_.unpaired));
}

void Preflight::add_image_doubts(std::vector<std::string>& doubts) const {
  std::vector<double> greys;
  for (const Seen& seen : frames_) greys.push_back(seen.mean_grey);
  const double grey = median(std::move(greys));
  if (grey < kDark)
    doubts.push_back(
        fmt::format("the image is dark ({} of 255): make more light", printf_text("%.0f", grey)));
  if (grey > kBright)
    doubts.push_back(
        fmt::format("the image is overexposed ({} of 255): less light, or look away from it",
                    printf_text("%.0f", grey)));
}

std::vector<std::string> Preflight::doubts() const {
  CHECK(!frames_.empty(), "nothing was looked at");
  const evaluate::DepthSurvey survey = depth_.survey();
  const double units = camera_.camera.depth_units_per_metre;
  std::vector<std::string> doubts;
  if (survey.median == 0) {
    doubts.push_back("no pixel has depth: the lens is covered, or everything is nearer than 0.5 m");
  } else {
    doubts = evaluate::depth_doubts(
        {survey, evaluate::guess_depth_unit(survey, units), registration_.fit(), units});
    if (survey.median / units < kTooNear_m)
      doubts.push_back(
          fmt::format("too near: half of what is seen is nearer than {}; step back to 0.8 to 3 m",
                      printf_text("%.2f m", survey.median / units)));
  }
  add_image_doubts(doubts);
  add_time_doubts(doubts);
  return doubts;
}

std::string Preflight::summary() const {
  const evaluate::DepthSurvey survey = depth_.survey();
  const double units = camera_.camera.depth_units_per_metre;
  return fmt::format(
      "{} frames at {}, {} of the pixels have depth, {} to {}", frames_.size(),
      printf_text("%.3g Hz", rate_hz()), printf_text("%.0f %%", 100 * survey.valid_share),
      printf_text("%.2f", survey.nearest / units), printf_text("%.2f m", survey.farthest / units));
}

}  // namespace hermite::client
