#include "core/track/odometry.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/frame/shared_transform.h"
#include "core/gpu/buffer_bytes.h"
#include "core/track/normal_equations.h"
#include "core/track/pose_choice.h"
#include "core/track/step_accelerator.h"

namespace hermite::track {

namespace {

constexpr std::uint32_t kMaxGroups = HERMITE_ODOMETRY_GROUPS;
// Adding up a workgroup's terms costs as much as several pixels of each of its threads. A CPU
// device gains nothing from more workgroups. On an H100, which has room for all of them at once,
// the passes of TUM fr1 take 0.28, 0.25, 0.23 and 0.23 ms a frame with 8, 4, 2 and 1 pixels; with
// fewer, the host has more sums to add.
std::uint32_t pixels_per_thread(const gpu::Device& device) {
  return device.info().kind == gpu::DeviceKind::kCpu ? 64 : 4;
}

// Fine enough for a tenth of a degree, coarse enough for several degrees.
constexpr std::size_t kRotationLevel = 1;

// Steps below this, at full resolution, are far below the noise of any depth camera and below the
// effect of changed correspondences: 0.03 mm and 0.0017 degrees.
constexpr double kConverged_m = 3e-5, kConverged_rad = 3e-5;

// Share of the frame's gradients that the map shows (odometry_sums.h): a black image, or a dark one
// of noise, has -0.03 to 0.09, recordings of a Kinect with its rolling shutter 0.23 to 0.75,
// rendered rooms 0.57 and more.
constexpr double kNoiseShare = 0.1, kImageShare = 0.2;

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

// Standard deviations of the sensor.
constexpr double kFirstGeometricScale = 10, kLeastGeometricScale = 0.25;
// On recordings and rendered rooms without motion the spread of grey values is 2 to 7;
// options.photometric_sigma applies to this value. If image and map agree less, the image has less
// weight.
constexpr double kUsualPhotometricScale_grey = 4;
constexpr double kFirstPhotometricScale_grey = 30, kLeastPhotometricScale_grey = 2;

// Shares of a frame with a surface below which corners have full weight and above which they have
// none: dense terms are better there, since they relate the camera to the map, corners only to the
// last frame. For the same reason a corner counts less than a dense pair of the same deviation:
// with a tenth of the depth, living_room_part, bare walls and fr1 end 3.1, 5.1 and 18 mm off
// without corners; 3.1, 2.2 and 17 with this weight; 9.1, 2.0 and 18 with a weight of 1; 33, 2.4
// and 24 with 20.
constexpr double kSparse = 0.15, kDense = 0.3, kCornerWeight = 0.3;

// Guesses linearised in one submission; the partial sums have room for this many.
constexpr std::size_t kGuessesAtOnce = 4;

// Half the window of the search for the least dissimilar point, in pixels.
constexpr std::uint32_t kSearchRadius = 2;

// A lost camera is searched for with gates three times as wide. Starts often lead to the same pose,
// so more of them are tried until there are this many poses to compare.
constexpr double kSearchReach = 3;
constexpr std::size_t kSearchTries = 6, kComparedPoses = 3;

// Returns the number of invocations for this many pixels each, as whole workgroups.
std::uint32_t threads_for(std::uint32_t pixel_count, std::uint32_t pixels_per_thread) {
  const std::uint32_t pixels_per_group = pixels_per_thread * HERMITE_ODOMETRY_GROUP_SIZE;
  return HERMITE_ODOMETRY_GROUP_SIZE *
         std::clamp((pixel_count + pixels_per_group - 1) / pixels_per_group, 1u, kMaxGroups);
}

// Returns the sums over all workgroups of a dispatch, added in order.
template <shared::uint N>
std::array<double, N> total(std::span<const float> partial_sums, std::uint32_t threads,
                            std::size_t first_group = 0) {
  std::array<double, N> sums{};
  for (std::size_t group = first_group; group < first_group + threads / HERMITE_ODOMETRY_GROUP_SIZE;
       ++group)
    for (std::size_t term = 0; term < N; ++term)
      sums[term] += static_cast<double>(partial_sums[group * N + term]);
  return sums;
}

}  // namespace

// Assumptions about residuals before a step.
struct Odometry::Believed {
  double geometric_scale = 0;    // standard deviations of the sensor
  double photometric_scale = 0;  // grey values
  frame::Brightness brightness;
};

Odometry::Odometry(gpu::Device& device, const shared::Intrinsics& finest,
                   const TrackOptions& options, const frame::FrameOptions& noise)
    : options_(options),
      noise_(noise),
      pixels_per_thread_(pixels_per_thread(device)),
      odometry_(device, "track/odometry", {0}),
      rotation_(device, "track/rotation"),
      agreement_(device, "track/agreement"),
      commands_(device),
      residual_model_(device, 1, "odometry", gpu::Memory::kReadback),
      partial_sums_(device, kGuessesAtOnce * kMaxGroups * shared::kOdometrySumCount, "odometry",
                    gpu::Memory::kReadback),
      previous_intensity_(device,
                          static_cast<std::size_t>(finest.width >> kRotationLevel) *
                              (finest.height >> kRotationLevel),
                          "odometry") {
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
  Believed believed;
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
  const auto& [level, gates, believed] = terms;
  const frame::SurfaceLevel &from = frame.surface.levels[level], &to = reference.levels[level];
  const shared::ResidualModel model{static_cast<float>(noise_.noise_floor_m),
                                    static_cast<float>(noise_.noise_growth_per_m),
                                    static_cast<float>(believed.geometric_scale),
                                    static_cast<float>(believed.photometric_scale),
                                    static_cast<float>(options_.photometric_gate),
                                    static_cast<float>(options_.mature_confidence),
                                    static_cast<float>(believed.brightness.gain),
                                    static_cast<float>(believed.brightness.offset)};
  residual_model_.upload({&model, 1});
  const std::uint32_t threads =
      threads_for(from.camera.width * from.camera.height, pixels_per_thread_);
  const std::uint32_t groups = threads / HERMITE_ODOMETRY_GROUP_SIZE;
  for (std::uint32_t i = 0; i < guesses.size(); ++i) {
    const shared::OdometryParams params{
        frame::to_shared(guesses[i]),
        from.camera,
        to.camera,
        static_cast<float>(options_.geometric_weight),
        static_cast<float>(gates.distance_m),
        static_cast<float>(std::sin(gates.normal_rad)),
        static_cast<float>(options_.photometric_sigma * believed.photometric_scale /
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
    sums.emplace_back(total<shared::kOdometrySumCount>(partial_sums_.mapped(), threads, i * groups),
                      static_cast<double>(from.camera.width) * from.camera.height);
  return sums;
}

// Returns the weight of corners relative to the dense terms, in their units; it grows as depth gets
// sparse.
double Odometry::weight_of_corners(const OdometrySums& sums) {
  const double fade =
      std::clamp((kDense - sums.surface_count / sums.pixel_count) / (kDense - kSparse), 0.0, 1.0);
  return kCornerWeight * fade * (sums.geometric_count > 0 ? sums.geometric_unit() : 1);
}

// The image constrains the camera where normals are noisier than their accepted pairs suggest. As
// evidence on its own, and if the image is not used, depth counts only beyond all of that noise.
NormalEquations Odometry::known_of_depth(const OdometrySums& sums, double disagreement) const {
  return options_.discount_normal_noise
             ? discount_normal_noise(sums.geometric, sums.displacement, disagreement)
             : sums.geometric;
}

// Returns the weight of the image as evidence at the final pose: gradients of noise wrongly say
// with certainty that the camera stands still. During the alignment the image has full weight in
// all steps, because one that is not aligned yet may look like noise.
double Odometry::share_of_image(const OdometrySums& sums) {
  return std::clamp((sums.gradient_share - kNoiseShare) / (kImageShare - kNoiseShare), 0.0, 1.0);
}

// Before the first step the pose may be off by centimetres, and the exposure by a fifth.
Odometry::Believed Odometry::believed_at_first(double reach) {
  return {reach * kFirstGeometricScale, kFirstPhotometricScale_grey, {}};
}

// Scales follow the residuals, down to the model's error and the quantisation of grey values;
// closer agreement is chance.
Odometry::Believed Odometry::believed_after(const Believed& before, const OdometrySums& sums,
                                            const Vector6d& step) {
  Believed after = before;
  if (sums.geometric_spread2 > 0)
    after.geometric_scale = std::max(std::sqrt(sums.geometric_spread2), kLeastGeometricScale);
  if (sums.photometric_spread2 > 0)
    after.photometric_scale =
        std::max(std::sqrt(sums.photometric_spread2), kLeastPhotometricScale_grey);
  after.brightness = brightness_after(sums.photometric, before.brightness, step);
  return after;
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
        frame, reference, some, {frame::kPyramidLevels - 1, gates, believed_at_first(reach)});
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
                        const Believed& believed) {
  result.inlier_count = static_cast<std::int64_t>(sums.geometric_count);
  result.gradient_share = sums.gradient_share;
  result.photometric_count = static_cast<std::int64_t>(sums.photometric_count);
  result.inlier_ratio = sums.surface_count > 0 ? sums.geometric_count / sums.surface_count : 0;
  result.residual_rms_m =
      sums.geometric_count > 0 ? std::sqrt(sums.geometric_error_m2 / sums.geometric_count) : 0;
  result.observability = observability(
      result.witnesses.depth.system.hessian +
          share_of_image(sums) * without_brightness(sums.photometric, believed.brightness).hessian,
      sums.displacement);
  result.brightness = believed.brightness;
  result.geometric_scale = believed.geometric_scale;
  result.photometric_scale = believed.photometric_scale;
}

OdometryResult Odometry::refine(const frame::FrameMaps& frame,
                                const frame::SurfacePyramid& reference, const Start& start,
                                double reach, const FeatureMotion* features) {
  OdometryResult result;
  result.reference_from_camera = start.guess;
  const int iterations[frame::kPyramidLevels] = {
      options_.max_iterations_fine, options_.max_iterations_middle, options_.max_iterations_coarse};
  OdometrySums sums{};
  Believed believed = believed_at_first(reach);
  for (int level = frame::kPyramidLevels - 1; level >= 0; --level) {
    const double scale = std::ldexp(1.0, level);
    Gates gates = gates_within(level == frame::kPyramidLevels - 1 ? reach : 1.0);
    StepAccelerator accelerator;
    const int steps =
        static_cast<int>(iterations[level] * gates.distance_m / options_.distance_gate_m);
    for (int i = 0; i < steps; ++i) {
      const bool is_known = result.iteration_count == 0 && start.sums;
      sums = is_known ? *start.sums
                      : linearise(frame, reference, {&result.reference_from_camera, 1},
                                  {static_cast<std::size_t>(level), gates, believed})[0];
      ++result.iteration_count;
      const NormalEquations known = known_of_depth(sums, sums.near_disagreement);
      const NormalEquations geometric =
          start.with_image ? known_of_depth(sums, sums.disagreement) : known;
      NormalEquations photometric = without_brightness(sums.photometric, believed.brightness);
      const double shared = share_of_image(sums);
      result.witnesses = {{known, sums.geometric_unit()},
                          {{shared * photometric.hessian, shared * photometric.right_hand_side},
                           shared * sums.photometric_unit()},
                          {},
                          0,
                          sums.displacement};
      if (!start.with_image)
        photometric = motion_prior(sums.geometric_unit(),
                                   log_se3(result.reference_from_camera * inverse(start.guess)));
      if (features) {
        result.witnesses.corners = {feature_terms(*features, result.reference_from_camera), 1};
        result.witnesses.corner_weight = weight_of_corners(sums);
        photometric.hessian +=
            result.witnesses.corner_weight * result.witnesses.corners.system.hessian;
        photometric.right_hand_side +=
            result.witnesses.corner_weight * result.witnesses.corners.system.right_hand_side;
      }
      const Vector6d proposed = solve(geometric, photometric, sums.displacement);
      if (!proposed.allFinite()) return result;
      // Coarse levels are cheap, and while steps are large the next one cannot be predicted: on
      // bare walls one alignment ended 35 cm off.
      const Vector6d step = level == 0 ? accelerator.next(proposed, sums.displacement) : proposed;
      believed = believed_after(believed, sums, step);
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
  describe(result, sums, believed);
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
      threads_for(from.camera.width * from.camera.height, pixels_per_thread_);
  commands_.dispatch(agreement_, {threads}, params,
                     {{"points", from.points},
                      {"intensity", from.intensity},
                      {"reference_points", to.points},
                      {"reference_intensity", to.intensity},
                      {"partial_sums", partial_sums_}});
  commands_.submit_and_wait();
  const auto sums = total<shared::kAgreementSumCount>(partial_sums_.mapped(), threads);
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

Eigen::Quaterniond Odometry::align_rotation(const frame::FrameMaps& frame) {
  Eigen::Quaterniond current_from_previous = Eigen::Quaterniond::Identity();
  if (!has_previous_) return current_from_previous;
  const frame::SurfaceLevel& image = frame.surface.levels[kRotationLevel];
  const std::uint32_t threads =
      threads_for(image.camera.width * image.camera.height, pixels_per_thread_);
  Eigen::Quaterniond best = current_from_previous;
  double best_error = 1e300;
  for (int i = 0; i < 10; ++i) {
    commands_.dispatch(
        rotation_, {threads},
        shared::RotationParams{frame::to_shared({current_from_previous, Eigen::Vector3d::Zero()}),
                               previous_camera_, image.camera},
        {{"previous", previous_intensity_},
         {"current", image.intensity},
         {"partial_sums", partial_sums_}});
    commands_.submit_and_wait();
    const auto sums = total<shared::kRotationSumCount>(partial_sums_.mapped(), threads);
    const double count = sums[shared::kRotationErrorSums + 1],
                 error = count > 0 ? sums[shared::kRotationErrorSums] / count : 1e300;
    if (error >= best_error) break;  // also if it stopped decreasing
    best_error = error;
    best = current_from_previous;
    // H | b.
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> system(
        sums.data() + shared::kRotationSystemSums);
    const Eigen::Vector3d step = system.leftCols<3>().eval().ldlt().solve(system.col(3));
    if (!step.allFinite() || step.norm() < 1e-5) break;
    Vector6d twist = Vector6d::Zero();
    twist.tail<3>() = step;
    current_from_previous = (exp_se3(twist).rotation * current_from_previous).normalized();
  }
  return best;
}

void Odometry::remember(gpu::Commands& commands, const frame::FrameMaps& frame) {
  const frame::SurfaceLevel& image = frame.surface.levels[kRotationLevel];
  commands.copy(image.intensity, previous_intensity_, image.intensity.bytes());
  previous_camera_ = image.camera;
  has_previous_ = true;
}

void Odometry::save(ByteWriter& bytes) const {
  bytes.flag(has_previous_);
  bytes.number(previous_camera_);
  gpu::save(bytes, previous_intensity_);
}

void Odometry::restore(ByteReader& bytes) {
  bytes.flag(has_previous_);
  bytes.number(previous_camera_);
  const std::uint64_t pixels = std::uint64_t{previous_camera_.width} * previous_camera_.height;
  bytes.require(pixels == (has_previous_ ? previous_intensity_.count() : 0),
                "the camera of the last picture");
  gpu::restore(bytes, previous_intensity_);
}

}  // namespace hermite::track
