#include "core/track/odometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/frame/shared_transform.h"
#include "core/track/normal_equations.h"
#include "core/track/odometry_step.h"
#include "core/track/pose_choice.h"
#include "core/track/step_accelerator.h"
#include "core/track/workgroup_sums.h"

namespace hermite::track {

namespace {

// Steps below this, at full resolution, are far below the noise of any depth camera and below the
// effect of changed correspondences: 0.03 mm and 0.0017 degrees.
constexpr double kConverged_m = 3e-5, kConverged_rad = 3e-5;

// Unrelated gradients have a share of 0 with a standard deviation of one over the square root of
// their number, if those of the map are as strong as the frame's. The map's are means of many
// frames, so noise hardly ever exceeds one deviation.
constexpr double kSurelyShared = 1;

// The smallest gradient that localises a pixel, in grey values per pixel, by level.
constexpr float kGradientMin[frame::kPyramidLevels] = {5, 3, 1};

// Coarse enough to average noise, fine enough to compare images. The tolerance is that of the model
// plus three times the noise of a Kinect v1 (Nguyen, Izadi, Lovell 2012), which other cameras do
// not exceed.
constexpr std::size_t kAgreementLevel = 1;
constexpr float kTolerance_m = 0.015f, kToleranceGrowth_per_m = 0.0057f;

// On recordings and rendered rooms without motion the spread of grey values is 2 to 7;
// options.photometric_sigma applies to this value. If image and map agree less, the image has less
// weight.
constexpr double kUsualPhotometricScale_grey = 4;

// Guesses linearised in one submission; the partial sums have room for this many.
constexpr std::size_t kGuessesAtOnce = 4;

// Half the window of the search for the least dissimilar point, in pixels.
constexpr std::uint32_t kSearchRadius = 2;

// A lost camera is searched for with gates three times as wide. Starts often lead to the same pose,
// so more of them are tried until there are this many poses to compare.
constexpr double kSearchReach = 3;
constexpr std::size_t kSearchTries = 6, kComparedPoses = 3;

}  // namespace

Odometry::Odometry(gpu::Device& device, const shared::Intrinsics& finest,
                   const TrackOptions& options, const frame::FrameOptions& noise)
    : options_(options),
      noise_(noise),
      pixels_per_thread_(pixels_per_thread(device)),
      odometry_(device, "track/odometry", {0}),
      agreement_(device, "track/agreement"),
      commands_(device),
      residual_model_(device, 1, "odometry", gpu::Memory::kReadback),
      partial_sums_(device, kGuessesAtOnce * kMaxOdometryGroups * shared::kOdometrySumCount,
                    "odometry", gpu::Memory::kReadback),
      rotation_(device, finest, commands_, partial_sums_) {
  if (options.dissimilarity_search)
    searching_.emplace(device, "track/odometry", std::vector{kSearchRadius});
}

// Points beyond these limits do not correspond.
struct Odometry::Gates {
  double distance_m = 0, normal_rad = 0;
  bool search = false;  // whether to search a window for the least dissimilar point
};

Odometry::Gates Odometry::gates_within(double reach) const {
  return {reach * options_.distance_gate_m,
          std::min(reach * options_.normal_gate_deg, 90.0) * M_PI / 180.0, false};
}

// What a linearisation depends on besides the images and the guesses.
struct Odometry::Terms {
  std::size_t level = 0;  // of the pyramids
  Gates gates;
  ExpectedResiduals expected;
};

// Start of an alignment, with the sums there if they are known.
struct Odometry::Start {
  Rigid3 guess;
  std::optional<OdometrySums> sums;
  // False: depth and corners alone, with a prior at the guess for directions that these leave free.
  bool with_image = true;
};

// Linearises at each of the guesses, at most kGuessesAtOnce, in one submission.
std::vector<OdometrySums> Odometry::linearise(const frame::FrameMaps& frame,
                                              const frame::SurfacePyramid& reference,
                                              std::span<const Rigid3> guesses, const Terms& terms) {
  const auto& [level, gates, expected] = terms;
  const frame::SurfaceLevel &from = frame.surface.levels[level], &to = reference.levels[level];
  const shared::ResidualModel model{static_cast<float>(noise_.noise_floor_m),
                                    static_cast<float>(noise_.noise_growth_per_m),
                                    static_cast<float>(expected.geometric_scale),
                                    static_cast<float>(expected.photometric_scale),
                                    static_cast<float>(options_.photometric_gate),
                                    static_cast<float>(options_.mature_confidence),
                                    static_cast<float>(expected.brightness.gain),
                                    static_cast<float>(expected.brightness.offset)};
  residual_model_.upload({&model, 1});
  const std::uint32_t threads =
      odometry_threads(from.camera.width * from.camera.height, pixels_per_thread_);
  const std::uint32_t groups = threads / HERMITE_ODOMETRY_GROUP_SIZE;
  for (std::uint32_t i = 0; i < guesses.size(); ++i) {
    const shared::OdometryParams params{
        frame::to_shared(guesses[i]),
        from.camera,
        to.camera,
        static_cast<float>(options_.geometric_weight),
        static_cast<float>(gates.distance_m),
        static_cast<float>(std::sin(gates.normal_rad)),
        static_cast<float>(options_.photometric_sigma * expected.photometric_scale /
                           kUsualPhotometricScale_grey),
        kGradientMin[level],
        static_cast<float>(options_.photometric_depth_gate_m),
        i * groups};
    commands_.dispatch(gates.search ? *searching_ : odometry_, {threads}, params,
                       {{"points", from.points},
                        {"image", frame.images[level]},
                        {"reference_points", to.points},
                        {"reference_intensity", to.intensity},
                        {"partial_sums", partial_sums_},
                        {"residual_model", residual_model_}});
  }
  commands_.submit_and_wait();
  std::vector<OdometrySums> sums;
  for (std::size_t i = 0; i < guesses.size(); ++i)
    sums.emplace_back(
        sum_of_groups<shared::kOdometrySumCount>(partial_sums_.mapped(), threads, i * groups),
        static_cast<double>(from.camera.width) * from.camera.height);
  return sums;
}

// Returns the guesses in order of the mean distance at the coarsest level, smallest first; points
// without a match count with the gate's distance.
std::vector<Odometry::Start> Odometry::by_misfit(std::span<const Rigid3> guesses,
                                                 const frame::FrameMaps& frame,
                                                 const frame::SurfacePyramid& reference,
                                                 double reach) {
  if (guesses.size() == 1) return {{guesses[0], std::nullopt}};
  const Gates gates = gates_within(reach);
  std::vector<Start> starts;
  for (std::size_t first = 0; first < guesses.size(); first += kGuessesAtOnce) {
    const auto some = guesses.subspan(first, std::min(kGuessesAtOnce, guesses.size() - first));
    const std::vector<OdometrySums> sums = linearise(
        frame, reference, some, {frame::kPyramidLevels - 1, gates, residuals_at_first(reach)});
    for (std::size_t i = 0; i < some.size(); ++i) starts.push_back({some[i], sums[i]});
  }
  const auto misfit_m2 = [&gates](const Start& start) {
    const OdometrySums& sums = *start.sums;
    return sums.geometric_error_m2 +
           (sums.surface_count - sums.geometric_count) * gates.distance_m * gates.distance_m;
  };
  std::stable_sort(starts.begin(), starts.end(),
                   [&](const Start& a, const Start& b) { return misfit_m2(a) < misfit_m2(b); });
  return starts;
}

// Describes the found motion by the last linearisation.
void Odometry::describe(OdometryResult& result, const OdometrySums& sums,
                        const ExpectedResiduals& expected) {
  result.inlier_count = static_cast<std::int64_t>(sums.geometric_count);
  result.gradient_share = sums.gradient_share;
  result.photometric_count = static_cast<std::int64_t>(sums.photometric_count);
  result.inlier_ratio = sums.surface_count > 0 ? sums.geometric_count / sums.surface_count : 0;
  result.residual_rms_m =
      sums.geometric_count > 0 ? std::sqrt(sums.geometric_error_m2 / sums.geometric_count) : 0;
  result.observability = observability(
      result.witnesses.depth.system.hessian +
          share_of_image(sums) * without_brightness(sums.photometric, expected.brightness).hessian,
      sums.displacement);
  result.brightness = expected.brightness;
  result.geometric_scale = expected.geometric_scale;
  result.photometric_scale = expected.photometric_scale;
}

OdometryResult Odometry::refine(const frame::FrameMaps& frame,
                                const frame::SurfacePyramid& reference, const Start& start,
                                double reach, const FeatureMotion* features) {
  OdometryResult result;
  result.reference_from_camera = start.guess;
  const int iterations[frame::kPyramidLevels] = {
      options_.max_iterations_fine, options_.max_iterations_middle, options_.max_iterations_coarse};
  OdometrySums sums{};
  ExpectedResiduals expected = residuals_at_first(reach);
  for (int level = frame::kPyramidLevels - 1; level >= 0; --level) {
    const double scale = std::ldexp(1.0, level);
    const StepTerms terms{options_.discount_normal_noise, level == 0,
                          start.with_image ? std::nullopt : std::optional(start.guess), features};
    Gates gates = gates_within(level == frame::kPyramidLevels - 1 ? reach : 1.0);
    StepAccelerator accelerator;
    const int steps =
        static_cast<int>(iterations[level] * gates.distance_m / options_.distance_gate_m);
    for (int i = 0; i < steps; ++i) {
      const bool is_known = result.iteration_count == 0 && start.sums;
      sums = is_known ? *start.sums
                      : linearise(frame, reference, {&result.reference_from_camera, 1},
                                  {static_cast<std::size_t>(level), gates, expected})[0];
      ++result.iteration_count;
      const StepSystems at =
          step_systems(sums, expected.brightness, result.reference_from_camera, terms);
      result.witnesses = at.witnesses;
      const Vector6d proposed = solve(at.geometric, at.photometric, sums.displacement);
      if (!proposed.allFinite()) return result;
      // Coarse levels are cheap, and while steps are large the next one cannot be predicted: on
      // bare walls one alignment ended 35 cm off.
      const Vector6d step = level == 0 ? accelerator.next(proposed, sums.displacement) : proposed;
      expected = residuals_after(expected, sums, step);
      result.reference_from_camera = exp_se3(step) * result.reference_from_camera;
      const bool converged = proposed.head<3>().norm() < scale * kConverged_m &&
                             proposed.tail<3>().norm() < scale * kConverged_rad;
      if (converged && (gates.search || level > 0 || !options_.dissimilarity_search)) break;
      // At full resolution the costly search starts once projective association has converged.
      const bool last_two = i + 3 >= steps;
      gates.search =
          level == 0 && options_.dissimilarity_search && (converged || gates.search || last_two);
    }
  }
  describe(result, sums, expected);
  result.agreement = agreement(frame, reference, result.reference_from_camera);
  return result;
}

OdometryResult Odometry::track(const frame::FrameMaps& frame,
                               const frame::SurfacePyramid& reference,
                               std::span<const Rigid3> guesses, const FeatureMotion* features) {
  const Start start = by_misfit(guesses, frame, reference, 1.0).front();
  const OdometryResult found = refine(frame, reference, start, 1.0, features);
  // Image noise leads anywhere in the directions that depth leaves free. But an image that is not
  // aligned yet may look like noise, so it is used until it turns out to be noise at the resulting
  // pose. An image with contrast that the map does not share is of another place.
  const double count = static_cast<double>(found.photometric_count);
  const bool is_shared = count > 0 && found.gradient_share > kSurelyShared / std::sqrt(count);
  if (is_shared || has_image(found.agreement)) return found;
  return refine(frame, reference, {start.guess, start.sums, false}, 1.0, features);
}

OdometryResult Odometry::search(const frame::FrameMaps& frame,
                                const frame::SurfacePyramid& reference,
                                std::span<const Rigid3> guesses) {
  std::vector<Start> ordered = by_misfit(guesses, frame, reference, kSearchReach);
  ordered.resize(std::min(ordered.size(), kSearchTries));
  std::vector<OdometryResult> poses;
  for (auto start = ordered.begin(); start != ordered.end() && poses.size() < kComparedPoses;
       ++start)
    add_pose(poses, refine(frame, reference, *start, kSearchReach));
  return best_pose(std::move(poses), options_);
}

Agreement Odometry::agreement(const frame::FrameMaps& frame, const frame::SurfacePyramid& reference,
                              const Rigid3& reference_from_camera) {
  const frame::SurfaceLevel& from = frame.surface.levels[kAgreementLevel];
  const frame::SurfaceLevel& to = reference.levels[kAgreementLevel];
  const shared::AgreementParams params{frame::to_shared(reference_from_camera), from.camera,
                                       to.camera, kTolerance_m, kToleranceGrowth_per_m};
  const std::uint32_t threads =
      odometry_threads(from.camera.width * from.camera.height, pixels_per_thread_);
  commands_.dispatch(agreement_, {threads}, params,
                     {{"points", from.points},
                      {"intensity", from.intensity},
                      {"reference_points", to.points},
                      {"reference_intensity", to.intensity},
                      {"partial_sums", partial_sums_}});
  commands_.submit_and_wait();
  const auto sums = sum_of_groups<shared::kAgreementSumCount>(partial_sums_.mapped(), threads);
  const double surface = sums[shared::kSurfaceSum], overlap = sums[shared::kOverlapSum],
               coloured = sums[shared::kColouredSum];
  const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 0; };
  Agreement result;
  result.surface = share(surface, static_cast<double>(from.camera.width) * from.camera.height);
  result.overlap = share(overlap, surface);
  result.agreeing = share(sums[shared::kAgreeingSum], overlap);
  result.in_front = share(sums[shared::kInFrontSum], overlap);
  if (coloured == 0) return result;
  const auto mean_of = [&](shared::uint term) { return sums[term] / coloured; };
  const double mean = mean_of(shared::kGreySums), reference_mean = mean_of(shared::kGreySums + 1);
  result.grey_deviation = std::sqrt(std::max(0.0, mean_of(shared::kGreySquareSums) - mean * mean));
  result.reference_grey_deviation = std::sqrt(
      std::max(0.0, mean_of(shared::kGreySquareSums + 1) - reference_mean * reference_mean));
  result.correlation = share(mean_of(shared::kGreySquareSums + 2) - mean * reference_mean,
                             result.grey_deviation * result.reference_grey_deviation);
  result.sharpness = share(sums[shared::kChangeSums], sums[shared::kChangeSums + 1]);
  return result;
}

}  // namespace hermite::track
