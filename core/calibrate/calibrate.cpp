#include "core/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/adjust/features.h"
#include "core/base/check.h"
#include "core/calibrate/camera_watch.h"
#include "core/calibrate/number_rules.h"
#include "core/calibrate/view_choice.h"
#include "core/dataset/camera_velocity.h"
#include "core/frame/rectify.h"

namespace hermite::calibrate {
namespace {

using Json = nlohmann::ordered_json;

// The least relative decrease of the held-out pairs' RMS, for all applied parameters together and
// for each one. Errors of points within a pair are correlated: in the rendered scenes the RMS of
// fitted and held-out pairs differs by 1 to 2 %. Changing one parameter does not change which pairs
// these are.
constexpr double kLeastGain = 0.02, kLeastGainOfOne = 0.005;

// The timing of images matters in fast movements only, and that of colour moves no surface, so it
// changes the RMS of all pairs by less than that. Instead, the held-out pairs must gain by this
// many standard errors, in their surfaces from the timing of depth and in their corners from that
// of colour.
constexpr double kLeastGainErrors = 3;

// A camera does not change during a recording. A half of it may differ from the whole by this share
// of the parameter, or by what is not significant in that half. The first 400 frames of redkitchen
// give an offset of 0.028 per metre and its frames 500 to 900 give 0.008, each with a deviation of
// 0.001, so it compensates for something else.
constexpr double kMostApartOfHalves = 0.5;

// Results from fewer views or pairs do not generalise.
constexpr std::size_t kLeastViews = 8, kLeastFittedPairs = 16, kLeastHeldBackPairs = 4;

struct Trial {
  JointSolution solution;
  PairAgreement held_back;
};

class Search {
 public:
  Search(const std::vector<CalibrationView>& views, const Camera& camera,
         const CalibrateOptions& options)
      : views_(views), camera_(camera), options_(options), pairs_(choose_pairs(views, camera)) {}

  const ChosenPairs& pairs() const { return pairs_; }
  const Camera& camera() const { return camera_; }

  Trial try_with(const FreeNumbers& is_free, const Trial* start = nullptr) const {
    Trial trial{adjust_jointly(views_, pairs_.fitted, camera_, joint_options(is_free),
                               start != nullptr ? &start->solution : nullptr),
                {}};
    trial.held_back = agreement_of(views_, trial.solution.world_from_camera, pairs_.held_back,
                                   changed(camera_, trial.solution.change));
    return trial;
  }

  // Returns by how many standard errors the held-out pairs gain in what the timing of depth or of
  // colour improves.
  double gain_in_errors(const Trial& without, const Trial& with, std::size_t number) const {
    const PairGain gain = gain_of(HeldOutPairs{views_, pairs_.held_back, camera_}, without.solution,
                                  with.solution, where_shows(number));
    return gain.standard_error > 0 ? gain.mean / gain.standard_error : 0;
  }

  // Returns the parameter in which the first or second half of the views differs most from `start`;
  // nullopt if both agree or are too small.
  std::optional<Objection> halves_objection(const FreeNumbers& is_free, const Trial& start) const {
    std::optional<Objection> worst;
    double most_apart = 1;
    for (const bool is_second : {false, true}) {
      const std::vector<ViewPair> half = pairs_of_half(pairs_.fitted, views_.size(), is_second);
      if (half.size() < kLeastFittedPairs) continue;
      const JointSolution solution =
          adjust_jointly(views_, half, camera_, joint_options(is_free), &start.solution);
      for (std::size_t k = 0; k < kCameraNumberCount; ++k) {
        const auto number = static_cast<Eigen::Index>(k);
        const double all = start.solution.change[number],
                     apart = std::abs(solution.change[number] - all);
        const double allowed = std::max(kMostApartOfHalves * std::abs(all),
                                        kLeastDeviations * solution.deviation[number]);
        if (!is_free[k] || !(apart > most_apart * allowed)) continue;
        most_apart = apart / allowed;
        worst = Objection{k, "the first and the second half of the recording disagree"};
      }
    }
    return worst;
  }

 private:
  JointOptions joint_options(const FreeNumbers& is_free) const {
    JointOptions options;
    options.is_free = is_free;
    options.thread_count = options_.thread_count;
    for (std::size_t k = 0; k < kCameraNumberCount; ++k)
      options.prior_deviation[static_cast<Eigen::Index>(k)] = prior_deviation(k, camera_);
    return options;
  }

  const std::vector<CalibrationView>& views_;
  const Camera camera_;
  const CalibrateOptions options_;
  const ChosenPairs pairs_;
};

Json agreement_json(const PairAgreement& agreement) {
  return {{"median_m", agreement.median_m},
          {"rms_m", agreement.rms_m},
          {"relative_rms", agreement.relative_rms},
          {"points", agreement.point_count}};
}

void record(const JointSolution& solution, std::size_t number, FoundNumber& found) {
  const double change = solution.change[static_cast<Eigen::Index>(number)];
  found.value = number == kFocal ? std::expm1(change) : change;
  found.deviation = solution.deviation[static_cast<Eigen::Index>(number)];
}

// Frees all parameters, and then takes back those that must not stay free. Holds references to both
// arguments; in `numbers` it records why a parameter was taken back.
class Elimination {
 public:
  Elimination(const Search& search, std::vector<FoundNumber>& numbers)
      : search_(search), numbers_(numbers) {}

  // The timing of images shows only if the camera's velocity is known.
  void run(bool are_twists_known, Lenses lenses) {
    is_free_.fill(true);
    if (!are_twists_known) hold_timing();
    if (lenses == Lenses::kTwo) {
      is_free_[kRadial] = false;
      numbers_[kRadial].reason = "depth and colour are seen through different lenses";
    }
    best_ = search_.try_with(is_free_);
    settle();
    for (std::size_t k = 0; k < kCameraNumberCount; ++k)
      if (is_free_[k]) try_without(k);
  }

  const FreeNumbers& is_free() const { return is_free_; }
  const Trial& best() const { return best_; }  // with the parameters that are free

 private:
  void hold_timing() {
    for (std::size_t k = kDepthReadout; k < kCameraNumberCount; ++k) {
      is_free_[k] = false;
      numbers_[k].reason =
          "the poses are too far apart in time, so that the camera's velocity is unknown";
    }
  }

  void take_back(const Objection& objection) {
    is_free_[objection.number] = false;
    record(best_.solution, objection.number, numbers_[objection.number]);
    numbers_[objection.number].reason = objection.reason;
  }

  // Takes parameters back until nothing speaks against the others.
  void settle() {
    for (;;) {
      std::vector<Objection> objections = objections_to(best_.solution, is_free_, search_.camera());
      if (objections.empty())
        if (const std::optional<Objection> of_halves = search_.halves_objection(is_free_, best_))
          objections.push_back(*of_halves);
      if (objections.empty()) return;
      for (const Objection& objection : objections) take_back(objection);
      best_ = search_.try_with(is_free_, &best_);
    }
  }

  // Takes the parameter back if the held-out pairs do not need it.
  void try_without(std::size_t number) {
    FreeNumbers without = is_free_;
    without[number] = false;
    Trial trial = search_.try_with(without, &best_);
    const bool is_needed =
        is_timing(number)
            ? search_.gain_in_errors(trial, best_, number) >= kLeastGainErrors
            : trial.held_back.relative_rms * (1 - kLeastGainOfOne) > best_.held_back.relative_rms;
    if (is_needed) return;
    take_back({number, "the held-out pairs of views agree as well without it"});
    best_ = std::move(trial);
    settle();
  }

  const Search& search_;
  std::vector<FoundNumber>& numbers_;
  FreeNumbers is_free_{};
  Trial best_;
};

// The timing has been confirmed by the held-out pairs parameter by parameter; the others must also
// matter together.
bool agrees_better(const Trial& as_it_was, const Trial& best) {
  return best.held_back.relative_rms < (1 - kLeastGain) * as_it_was.held_back.relative_rms &&
         best.held_back.relative_median <= as_it_was.held_back.relative_median;
}

// Returns what may still be wrong with the camera. What was found and not applied may be an error.
CameraDeviations deviations_of(const Calibration& found) {
  const auto known = [&found](CameraNumber number, double stated, double least) {
    const FoundNumber& of = found.numbers[number];
    if (!(of.deviation > 0)) return stated;  // was not measured
    const double left = of.is_applied ? of.deviation : std::hypot(of.value, of.deviation);
    return std::clamp(left, least, kMaxCameraDeviation);
  };
  const CameraDeviations& stated = found.camera.deviations;
  return {.bend = known(kBend, stated.bend, kFitting.bend),
          .focal = known(kFocal, stated.focal, kFitting.focal),
          .k1 = known(kRadial, stated.k1, kFitting.k1)};
}

// Decides whether the result is applied, by the agreement of the held-out pairs.
void conclude(Calibration& result, const Camera& camera, const Trial& as_it_was, const Trial& best,
              const FreeNumbers& is_free) {
  const bool is_any_free = std::ranges::find(is_free, true) != is_free.end();
  const bool is_timing_alone = std::find(is_free.begin(), is_free.begin() + kDepthReadout, true) ==
                               is_free.begin() + kDepthReadout;
  const Camera corrected = changed(camera, best.solution.change);
  result.is_applied = is_any_free && (is_timing_alone || agrees_better(as_it_was, best)) &&
                      validate(corrected).ok();
  if (!is_any_free)
    result.reason =
        "no parameter of the camera is off, or none reliably so; see the reason of each";
  for (std::size_t k = 0; k < kCameraNumberCount; ++k) {
    if (!is_free[k]) continue;
    record(best.solution, k, result.numbers[k]);
    result.numbers[k].is_applied = result.is_applied;
    if (!result.is_applied)
      result.numbers[k].reason = result.reason =
          "the held-out pairs of views do not agree better with the result";
  }
  if (!result.is_applied) return;
  result.camera = corrected;
  result.after = best.held_back;
}

}  // namespace

Calibration calibrate(const std::vector<CalibrationView>& views, const Camera& camera,
                      const CalibrateOptions& options) {
  Camera straight = rectified(camera);
  // Views are as measured, so these two apply to them.
  straight.depth_correction = camera.depth_correction;
  straight.timing = camera.timing;
  const Search search(views, straight, options);
  Calibration result;
  result.camera = camera;
  result.view_count = views.size();
  result.fitted_pair_count = search.pairs().fitted.size();
  result.held_back_pair_count = search.pairs().held_back.size();
  if (views.size() < kLeastViews || result.fitted_pair_count < kLeastFittedPairs ||
      result.held_back_pair_count < kLeastHeldBackPairs) {
    result.reason =
        "too few overlapping views: the camera must rotate and move more, and see some places from "
        "several sides";
    return result;
  }
  result.numbers.resize(kCameraNumberCount);
  for (std::size_t k = 0; k < kCameraNumberCount; ++k) result.numbers[k].name = name_of_number(k);
  const Trial as_it_was = search.try_with({});
  result.before = result.after = as_it_was.held_back;

  Elimination elimination(search, result.numbers);
  const bool are_twists_known = std::ranges::all_of(
      views, [](const CalibrationView& view) { return view.known_twist_per_s.has_value(); });
  elimination.run(are_twists_known, camera.color ? Lenses::kTwo : Lenses::kOne);
  conclude(result, camera, as_it_was, elimination.best(), elimination.is_free());
  result.camera.deviations = deviations_of(result);
  return result;
}

Calibration calibrate(const dataset::Sequence& sequence, dataset::FrameRange range,
                      const dataset::Trajectory& trajectory, const CalibrateOptions& options) {
  CHECK(options.max_view_count >= 2 && options.thread_count >= 1,
        "calibration needs at least two views and one thread");
  // Rectifies as the pipeline does, except for the depth correction, because patches need depth as
  // measured.
  Camera lenses = sequence.camera();
  lenses.depth_correction = {};
  const std::optional<frame::Rectifier> rectifier = frame::rectifier_of(lenses);
  const Camera straight = rectified(lenses);
  std::vector<CalibrationView> views;
  for (const ChosenFrame& chosen :
       choose_frames(sequence, range, trajectory, options.max_view_count)) {
    Result<dataset::RecordedFrame> recorded = sequence.read(chosen.index);
    if (!recorded.ok()) continue;
    Result<frame::RgbdFrame> frame = dataset::decode_frame(*std::move(recorded));
    if (!frame.ok() || frame->depth.width != straight.width ||
        frame->depth.height != straight.height)
      continue;
    if (rectifier) *frame = rectifier->apply(*frame);
    views.push_back({chosen.world_from_camera, patches_of(frame->depth, straight),
                     adjust::detect_features(*frame, straight),
                     dataset::twist_per_s_at(trajectory, sequence.timestamp_s(chosen.index))});
  }
  return calibrate(views, sequence.camera(), options);
}

std::string format_calibration_json(const Calibration& calibration) {
  Json json{{"applied", calibration.is_applied},
            {"reason", calibration.reason},
            {"views", calibration.view_count}};
  json["pairs_fitted"] = calibration.fitted_pair_count;
  json["pairs_held_back"] = calibration.held_back_pair_count;
  for (const FoundNumber& number : calibration.numbers)
    json["numbers"][number.name] = {{"value", number.value},
                                    {"deviation", number.deviation},
                                    {"applied", number.is_applied},
                                    {"reason", number.reason}};
  json["held_back"] = {{"before", agreement_json(calibration.before)},
                       {"after", agreement_json(calibration.after)}};
  return json.dump(2) + "\n";
}

}  // namespace hermite::calibrate
