#include "core/calibrate/number_rules.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hermite::calibrate {
namespace {

// Values in pixels are for an image 640 pixels wide.
struct NumberRule {
  const char* name;
  // Prior standard deviation: the usual difference between a camera's parameter and its nominal
  // value. TUM's three Kinects have focal lengths from 517 to 535 with a nominal 525, and principal
  // points some pixels off the centre. Bends are of the order of TUM's depth factors, 0 to 3.5 %.
  // Half a pixel of a Kinect's disparity (525 pixels, 75 mm) is 0.013 per metre.
  double deviation;
  // The least change that is applied. Noise alone causes less than 0.1 % of focal length, half a
  // pixel, 0.02 % of bend and 0.0004 per metre in the rendered scenes; errors that move a camera by
  // a few millimetres are larger (accuracy tests: 2 to 3 mm per 0.1 % of focal length, 5 to 6 mm
  // per 0.1 % of bend).
  double least;
};
constexpr std::array<NumberRule, kCameraNumberCount> kRules{{
    {"focal_factor", 0.010, 0.002},
    {"cx_px", 4, 1},
    {"cy_px", 4, 1},
    {"k1", 0.05, 0.003},
    {"bend", 0.015, 0.001},
    {"inverse_offset_per_m", 0.012, 0.002},
    // A shutter that reads a whole frame takes 33 ms, and a colour image that is paired with the
    // nearest depth image is at most half of that off. Noise alone causes less than 3 ms of readout
    // and 1 ms of delay in the rendered scenes.
    {"depth_readout_s", 0.015, 0.005},
    {"color_readout_s", 0.015, 0.005},
    {"color_delay_s", 0.012, 0.003},
}};
constexpr double kRuleWidth_px = 640;

constexpr double kMostPriorDeviations = 3;

// A parameter is clearly not needed if it is this many times smaller than the least that would be:
// one standard deviation in place of three.
constexpr double kClearly = 3;

double pixels_of(std::size_t number, const Camera& camera) {
  return number == kCenterX || number == kCenterY ? camera.width / kRuleWidth_px : 1;
}

}  // namespace

const char* name_of_number(std::size_t number) { return kRules[number].name; }

double prior_deviation(std::size_t number, const Camera& camera) {
  return kRules[number].deviation * pixels_of(number, camera);
}

std::vector<Objection> objections_to(const JointSolution& solution, const FreeNumbers& is_free,
                                     const Camera& camera) {
  struct Strength {
    double beyond = 1;
    const char* reason = nullptr;
  };
  std::array<Strength, kCameraNumberCount> objections;
  const auto object = [&](std::size_t number, double beyond, const char* reason) {
    if (beyond > objections[number].beyond) objections[number] = {beyond, reason};
  };
  const auto size_of = [&](std::size_t k) {
    return std::abs(solution.change[static_cast<Eigen::Index>(k)]) / pixels_of(k, camera);
  };
  const auto strongest = [&] {
    const auto worst = std::ranges::max_element(objections, {}, &Strength::beyond);
    return worst->reason == nullptr
               ? std::vector<Objection>{}
               : std::vector<Objection>{
                     {static_cast<std::size_t>(worst - objections.begin()), worst->reason}};
  };
  for (std::size_t k = 0; k < kCameraNumberCount; ++k)
    if (is_free[k])
      object(k, size_of(k) / (kMostPriorDeviations * kRules[k].deviation),
             "larger than a camera's plausible error");
  if (std::vector<Objection> implausible = strongest(); !implausible.empty()) return implausible;
  std::vector<Objection> clear;
  for (std::size_t k = 0; k < kCameraNumberCount; ++k) {
    if (!is_free[k]) continue;
    const double deviation =
        solution.deviation[static_cast<Eigen::Index>(k)] / pixels_of(k, camera);
    object(k, kLeastDeviations * deviation / size_of(k), "not significant");
    object(k, kRules[k].least / size_of(k), "too small to matter");
    if (objections[k].beyond >= kClearly) clear.push_back({k, objections[k].reason});
  }
  return clear.empty() ? strongest() : clear;
}

}  // namespace hermite::calibrate
