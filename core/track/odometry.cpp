#include "core/track/odometry.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/gpu/buffer_bytes.h"
#include "core/map/surfel_store.h"
#include "core/track/normal_equations.h"

namespace hermite {

namespace {

constexpr std::uint32_t kMaxGroups = HERMITE_ODOMETRY_GROUPS;
// Adding up a group's terms costs as much as several pixels of each of its threads. A processor has no use for more groups than that.
std::uint32_t pixels_per_thread(const gpu::Device& device) { return device.info().kind == gpu::DeviceKind::kCpu ? 64 : 16; }

// Fine enough for a tenth of a degree, coarse enough for several.
constexpr std::size_t kRotationLevel = 1;

// Smaller steps than this are far below the noise of any depth camera: 0.01 mm and 0.0006 degrees at full resolution.
constexpr double kConverged_m = 1e-5, kConverged_rad = 1e-5;

// The smallest image gradient that says where a pixel is, in grey values per pixel and level.
constexpr float kGradientMin[kPyramidLevels] = {5, 3, 1};

// Coarse enough to average noise, fine enough for a picture. What a model may be off by, and thrice the noise of a Kinect v1 (Nguyen,
// Izadi, Lovell 2012), which other cameras do not exceed.
constexpr std::size_t kAgreementLevel = 1;
constexpr float kTolerance_m = 0.015f, kToleranceGrowth_per_m = 0.0057f;

// Of Student's t distribution; as in shaders/track/odometry.comp (Kerl, Sturm, Cremers 2013 found 5 to fit).
constexpr double kDegreesOfFreedom = 5;
constexpr double kFirstGeometricScale = 10, kLeastGeometricScale = 0.25;  // standard deviations of the sensor
// The spread of grey values on recordings and rendered rooms where nothing moves is 2 to 7: there options.photometric_sigma is meant. Where
// picture and map agree less the picture says less.
constexpr double kUsualPhotometricScale_grey = 4;
constexpr double kFirstPhotometricScale_grey = 30, kLeastPhotometricScale_grey = 2;

// Shares of a frame with a surface below which corners count fully, and beyond which they do not: dense terms know better there, since
// corners hold the camera to the last frame, dense terms to the map. For the same reason a corner counts less than a dense pair of the same
// deviation: with a tenth of the depth, living_room_part, bare walls and fr1 end 3.1, 5.1 and 18 mm off without corners, 3.1, 2.2 and 17
// with this weight, 9.1, 2.0 and 18 with 1, 33, 2.4 and 24 with 20.
constexpr double kSparse = 0.15, kDense = 0.3, kCornerWeight = 0.3;

// A lost camera is searched for within thrice the usual gates, and so many ends are compared.
constexpr double kSearchReach = 3;
constexpr std::size_t kSearchTries = 3;

// Invocations that share so many pixels: whole workgroups.
std::uint32_t threads_for(std::uint32_t pixel_count, std::uint32_t pixels_per_thread) {
  const std::uint32_t pixels_per_group = pixels_per_thread * HERMITE_ODOMETRY_GROUP_SIZE;
  return HERMITE_ODOMETRY_GROUP_SIZE * std::clamp((pixel_count + pixels_per_group - 1) / pixels_per_group, 1u, kMaxGroups);
}

// Sums of all workgroups, in order.
template <shared::uint N>
std::array<double, N> total(std::span<const float> partial_sums, std::uint32_t threads) {
  std::array<double, N> sums{};
  for (std::size_t group = 0; group < threads / HERMITE_ODOMETRY_GROUP_SIZE; ++group)
    for (std::size_t term = 0; term < N; ++term) sums[term] += static_cast<double>(partial_sums[group * N + term]);
  return sums;
}

template <class Matrix>
Matrix read_upper_triangle(const double* next) {
  Matrix matrix;
  for (int i = 0; i < matrix.rows(); ++i)
    for (int j = i; j < matrix.cols(); ++j) matrix(i, j) = matrix(j, i) = *next++;
  return matrix;
}

NormalEquations read_system(const double* sums) {
  constexpr int kUpperTriangle = 21;
  return {read_upper_triangle<Matrix6d>(sums), Eigen::Map<const Vector6d>(sums + kUpperTriangle)};
}

// Of the points s: weighted sum of A^T A with A = [1, -[s]x], what a twist moves them by. `moments`: of 1, s and the upper triangle of s
// s^T.
Matrix6d read_displacement(const double* moments) {
  const Eigen::Vector3d first(moments[1], moments[2], moments[3]);
  const auto second = read_upper_triangle<Eigen::Matrix3d>(moments + 4);
  Matrix6d displacement = Matrix6d::Zero();
  displacement.topLeftCorner<3, 3>() = moments[0] * Eigen::Matrix3d::Identity();
  displacement.bottomLeftCorner<3, 3>() = skew(first);
  displacement.topRightCorner<3, 3>() = displacement.bottomLeftCorner<3, 3>().transpose();
  displacement.bottomRightCorner<3, 3>() = second.trace() * Eigen::Matrix3d::Identity() - second;
  return displacement;
}

}  // namespace

struct Odometry::Sums {
  NormalEquations geometric;
  PhotometricSystem photometric;
  Matrix6d displacement;  // of the geometric pairs
  double disagreement = 0;
  double geometric_base = 0;  // sum of the pairs' weights before residuals count
  double geometric_error_m2 = 0, geometric_count = 0, photometric_count = 0, surface_count = 0, pixel_count = 0;
  // Mean squares of the residuals as Student's t distribution has them, in scales squared; nothing where there are no pairs.
  double geometric_spread2 = 0, photometric_spread2 = 0;
  double photometric_squares = 0;  // sum of the weighted squared residuals

  // The mean weight of a pair whose residual is one deviation, times that residual squared.
  double geometric_unit() const {
    return geometric_count > 0 ? geometric_base / geometric_count * geometric_error_m2 / geometric_count : 0;
  }
  double photometric_unit() const { return photometric_count > 0 ? photometric_squares / photometric_count : 0; }
};

// What is believed of residuals before a step.
struct Odometry::Believed {
  double geometric_scale = 0;    // standard deviations of the sensor
  double photometric_scale = 0;  // grey values
  Brightness brightness;
};

Odometry::Odometry(gpu::Device& device, const shared::Intrinsics& finest, const TrackOptions& options, const FrameOptions& noise)
    : options_(options),
      noise_(noise),
      pixels_per_thread_(pixels_per_thread(device)),
      odometry_(device, "track/odometry"),
      rotation_(device, "track/rotation"),
      agreement_(device, "track/agreement"),
      commands_(device),
      residual_model_(device, 1, "odometry", gpu::Memory::kReadback),
      partial_sums_(device, std::size_t{kMaxGroups} * shared::kOdometrySumCount, "odometry", gpu::Memory::kReadback),
      previous_intensity_(device, static_cast<std::size_t>(finest.width >> kRotationLevel) * (finest.height >> kRotationLevel),
                          "odometry") {}

// Beyond these points do not correspond.
struct Odometry::Gates {
  double distance_m = 0, normal_rad = 0;
  bool search = false;  // a window for the least dissimilar point
};

Odometry::Gates Odometry::gates_within(double reach) const {
  return {reach * options_.distance_gate_m, std::min(reach * options_.normal_gate_deg, 90.0) * M_PI / 180.0, false};
}

Odometry::Sums Odometry::linearise(const FrameMaps& frame, const SurfacePyramid& reference, const Rigid3& guess, int level,
                                   const Gates& gates, const Believed& believed) {
  const auto l = static_cast<std::size_t>(level);
  const SurfaceLevel& from = frame.surface.levels[l];
  const SurfaceLevel& to = reference.levels[l];
  const shared::OdometryParams params{
      to_shared(guess),
      from.camera,
      to.camera,
      static_cast<float>(options_.geometric_weight),
      static_cast<float>(gates.distance_m),
      static_cast<float>(std::sin(gates.normal_rad)),
      static_cast<float>(options_.photometric_sigma * believed.photometric_scale / kUsualPhotometricScale_grey),
      kGradientMin[l],
      static_cast<float>(options_.photometric_depth_gate_m),
      gates.search ? 2u : 0u};
  const shared::ResidualModel model{static_cast<float>(noise_.noise_floor_m),      static_cast<float>(noise_.noise_growth_per_m),
                                    static_cast<float>(believed.geometric_scale),  static_cast<float>(believed.photometric_scale),
                                    static_cast<float>(options_.photometric_gate), static_cast<float>(options_.mature_confidence),
                                    static_cast<float>(believed.brightness.gain),  static_cast<float>(believed.brightness.offset)};
  residual_model_.upload({&model, 1});
  const std::uint32_t threads = threads_for(from.camera.width * from.camera.height, pixels_per_thread_);
  commands_.dispatch(odometry_, {threads}, params,
                     {{"points", from.points},
                      {"picture", frame.pictures[l]},
                      {"reference_points", to.points},
                      {"reference_intensity", to.intensity},
                      {"partial_sums", partial_sums_},
                      {"residual_model", residual_model_}});
  commands_.submit_and_wait();
  const auto terms = total<shared::kOdometrySumCount>(partial_sums_.mapped(), threads);
  const auto from_term = [&terms](shared::uint first) { return terms.data() + first; };
  Sums sums{};
  sums.geometric = read_system(from_term(shared::kGeometricSums));
  sums.photometric.motion = read_system(from_term(shared::kPhotometricSums));
  sums.displacement = read_displacement(from_term(shared::kMomentSums));
  const double weight = terms[shared::kMomentSums];
  sums.disagreement = weight > 0 ? terms[shared::kDisagreementSum] / weight : 0;
  sums.geometric_error_m2 = terms[shared::kGeometricErrorSums];
  sums.geometric_count = terms[shared::kGeometricErrorSums + 1];
  sums.photometric_count = terms[shared::kPhotometricErrorSums + 1];
  sums.surface_count = terms[shared::kSurfaceCountSum];
  sums.photometric.mixed = Eigen::Map<const Eigen::Matrix<double, 6, 2, Eigen::RowMajor>>(from_term(shared::kMixedSums));
  sums.photometric.hessian = read_upper_triangle<Eigen::Matrix2d>(from_term(shared::kBrightnessSums));
  sums.photometric.right_hand_side = Eigen::Map<const Eigen::Vector2d>(from_term(shared::kBrightnessSums + 3));
  constexpr double kOfStudentsT = (kDegreesOfFreedom + 1) / kDegreesOfFreedom;
  const double geometric_base = terms[shared::kGeometricSpreadSums], geometric_squares = terms[shared::kGeometricSpreadSums + 1];
  const double photometric_base = terms[shared::kPhotometricSpreadSums];
  sums.photometric_squares = terms[shared::kPhotometricSpreadSums + 1];
  sums.geometric_base = geometric_base;
  if (geometric_base > 0) sums.geometric_spread2 = kOfStudentsT * geometric_squares / geometric_base;
  if (photometric_base > 0) sums.photometric_spread2 = kOfStudentsT * sums.photometric_squares / photometric_base;
  sums.pixel_count = static_cast<double>(from.camera.width) * from.camera.height;
  return sums;
}

// What corners count beside the dense terms, in whose units: as far as depth is sparse.
double Odometry::weight_of_corners(const Sums& sums) {
  const double fade = std::clamp((kDense - sums.surface_count / sums.pixel_count) / (kDense - kSparse), 0.0, 1.0);
  return kCornerWeight * fade * (sums.geometric_count > 0 ? sums.geometric_unit() : 1);
}

// Before the first step the camera may be off by centimetres, and its exposure by a fifth.
Odometry::Believed Odometry::believed_at_first(double reach) { return {reach * kFirstGeometricScale, kFirstPhotometricScale_grey, {}}; }

// Scales follow the residuals. They end at what a model is off by and at the steps of grey values: closer agreement is chance.
Odometry::Believed Odometry::believed_after(const Believed& before, const Sums& sums, const Vector6d& step) {
  Believed after = before;
  if (sums.geometric_spread2 > 0) after.geometric_scale = std::max(std::sqrt(sums.geometric_spread2), kLeastGeometricScale);
  if (sums.photometric_spread2 > 0) after.photometric_scale = std::max(std::sqrt(sums.photometric_spread2), kLeastPhotometricScale_grey);
  after.brightness = brightness_after(sums.photometric, before.brightness, step);
  return after;
}

// Ordered by the mean distance at the coarsest level, least first, where what matches nothing counts as far as the gate.
std::vector<Rigid3> Odometry::by_misfit(std::span<const Rigid3> guesses, const FrameMaps& frame, const SurfacePyramid& reference,
                                        double reach) {
  std::vector<Rigid3> ordered(guesses.begin(), guesses.end());
  if (ordered.size() == 1) return ordered;
  const Gates gates = gates_within(reach);
  std::vector<std::pair<double, std::size_t>> misfits_m2;
  for (const Rigid3& guess : guesses) {
    const Sums sums = linearise(frame, reference, guess, kPyramidLevels - 1, gates, believed_at_first(reach));
    const double misfit_m2 = sums.geometric_error_m2 + (sums.surface_count - sums.geometric_count) * gates.distance_m * gates.distance_m;
    misfits_m2.emplace_back(misfit_m2, misfits_m2.size());
  }
  std::sort(misfits_m2.begin(), misfits_m2.end());
  for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = guesses[misfits_m2[i].second];
  return ordered;
}

OdometryResult Odometry::refine(const FrameMaps& frame, const SurfacePyramid& reference, const Rigid3& guess, double reach,
                                const FeatureMotion* features) {
  OdometryResult result;
  result.reference_from_camera = guess;
  const int iterations[kPyramidLevels] = {options_.max_iterations_fine, options_.max_iterations_middle, options_.max_iterations_coarse};
  Sums sums{};
  Believed believed = believed_at_first(reach);
  for (int level = kPyramidLevels - 1; level >= 0; --level) {
    const double scale = std::ldexp(1.0, level);
    Gates gates = gates_within(level == kPyramidLevels - 1 ? reach : 1.0);
    const int steps = static_cast<int>(iterations[level] * gates.distance_m / options_.distance_gate_m);
    for (int i = 0; i < steps; ++i) {
      sums = linearise(frame, reference, result.reference_from_camera, level, gates, believed);
      ++result.iteration_count;
      if (options_.discount_normal_noise) sums.geometric = discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement);
      NormalEquations photometric = without_brightness(sums.photometric, believed.brightness);
      result.witnesses = {{sums.geometric, sums.geometric_unit()}, {photometric, sums.photometric_unit()}, {}, 0};
      if (features) {
        result.witnesses.corners = {feature_terms(*features, result.reference_from_camera), 1};
        result.witnesses.corner_weight = weight_of_corners(sums);
        photometric.hessian += result.witnesses.corner_weight * result.witnesses.corners.system.hessian;
        photometric.right_hand_side += result.witnesses.corner_weight * result.witnesses.corners.system.right_hand_side;
      }
      const Vector6d step = solve(sums.geometric, photometric, sums.displacement);
      if (!step.allFinite()) return result;
      believed = believed_after(believed, sums, step);
      result.reference_from_camera = exp_se3(step) * result.reference_from_camera;
      const bool converged = step.head<3>().norm() < scale * kConverged_m && step.tail<3>().norm() < scale * kConverged_rad;
      if (converged && (gates.search || level > 0 || !options_.dissimilarity_search)) break;
      // At full resolution the costly search starts where projection has converged.
      const bool last_two = i + 3 >= steps;
      gates.search = level == 0 && options_.dissimilarity_search && (converged || gates.search || last_two);
    }
  }
  result.inlier_count = static_cast<std::int64_t>(sums.geometric_count);
  result.photometric_count = static_cast<std::int64_t>(sums.photometric_count);
  result.inlier_ratio = sums.surface_count > 0 ? sums.geometric_count / sums.surface_count : 0;
  result.residual_rms_m = sums.geometric_count > 0 ? std::sqrt(sums.geometric_error_m2 / sums.geometric_count) : 0;
  result.observability =
      observability(sums.geometric.hessian + without_brightness(sums.photometric, believed.brightness).hessian, sums.displacement);
  result.brightness = believed.brightness;
  result.geometric_scale = believed.geometric_scale;
  result.photometric_scale = believed.photometric_scale;
  result.agreement = agreement(frame, reference, result.reference_from_camera);
  return result;
}

OdometryResult Odometry::track(const FrameMaps& frame, const SurfacePyramid& reference, std::span<const Rigid3> guesses,
                               const FeatureMotion* features) {
  return refine(frame, reference, by_misfit(guesses, frame, reference, 1.0).front(), 1.0, features);
}

OdometryResult Odometry::search(const FrameMaps& frame, const SurfacePyramid& reference, std::span<const Rigid3> guesses) {
  std::vector<Rigid3> ordered = by_misfit(guesses, frame, reference, kSearchReach);
  ordered.resize(std::min(ordered.size(), kSearchTries));
  OdometryResult best;
  for (const Rigid3& guess : ordered) {
    const OdometryResult result = refine(frame, reference, guess, kSearchReach);
    const auto agreeing_share = [](const Agreement& a) { return a.overlap * a.agreeing; };
    if (&guess == &ordered.front() || agreeing_share(result.agreement) > agreeing_share(best.agreement)) best = result;
  }
  return best;
}

Agreement Odometry::agreement(const FrameMaps& frame, const SurfacePyramid& reference, const Rigid3& reference_from_camera) {
  const SurfaceLevel& from = frame.surface.levels[kAgreementLevel];
  const SurfaceLevel& to = reference.levels[kAgreementLevel];
  const shared::AgreementParams params{to_shared(reference_from_camera), from.camera, to.camera, kTolerance_m, kToleranceGrowth_per_m};
  const std::uint32_t threads = threads_for(from.camera.width * from.camera.height, pixels_per_thread_);
  commands_.dispatch(agreement_, {threads}, params,
                     {{"points", from.points},
                      {"intensity", from.intensity},
                      {"reference_points", to.points},
                      {"reference_intensity", to.intensity},
                      {"partial_sums", partial_sums_}});
  commands_.submit_and_wait();
  const auto sums = total<shared::kAgreementSumCount>(partial_sums_.mapped(), threads);
  const double surface = sums[shared::kSurfaceSum], overlap = sums[shared::kOverlapSum], coloured = sums[shared::kColouredSum];
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
  result.reference_grey_deviation = std::sqrt(std::max(0.0, mean_of(shared::kGreySquareSums + 1) - reference_mean * reference_mean));
  result.correlation =
      share(mean_of(shared::kGreySquareSums + 2) - mean * reference_mean, result.grey_deviation * result.reference_grey_deviation);
  result.sharpness = share(sums[shared::kChangeSums], sums[shared::kChangeSums + 1]);
  return result;
}

Eigen::Quaterniond Odometry::align_rotation(const FrameMaps& frame) {
  Eigen::Quaterniond current_from_previous = Eigen::Quaterniond::Identity();
  if (!has_previous_) return current_from_previous;
  const SurfaceLevel& image = frame.surface.levels[kRotationLevel];
  const std::uint32_t threads = threads_for(image.camera.width * image.camera.height, pixels_per_thread_);
  Eigen::Quaterniond best = current_from_previous;
  double best_error = 1e300;
  for (int i = 0; i < 10; ++i) {
    commands_.dispatch(rotation_, {threads},
                       shared::RotationParams{to_shared({current_from_previous, Eigen::Vector3d::Zero()}), previous_camera_, image.camera},
                       {{"previous", previous_intensity_}, {"current", image.intensity}, {"partial_sums", partial_sums_}});
    commands_.submit_and_wait();
    const auto sums = total<shared::kRotationSumCount>(partial_sums_.mapped(), threads);
    const double count = sums[shared::kRotationErrorSums + 1], error = count > 0 ? sums[shared::kRotationErrorSums] / count : 1e300;
    if (error >= best_error) break;  // also when it does not fall any more
    best_error = error;
    best = current_from_previous;
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> system(sums.data() + shared::kRotationSystemSums);  // H | b
    const Eigen::Vector3d step = system.leftCols<3>().eval().ldlt().solve(system.col(3));
    if (!step.allFinite() || step.norm() < 1e-5) break;
    Vector6d twist = Vector6d::Zero();
    twist.tail<3>() = step;
    current_from_previous = (exp_se3(twist).rotation * current_from_previous).normalized();
  }
  return best;
}

void Odometry::remember(gpu::Commands& commands, const FrameMaps& frame) {
  const SurfaceLevel& image = frame.surface.levels[kRotationLevel];
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
  bytes.require(pixels == (has_previous_ ? previous_intensity_.count() : 0), "the camera of the last picture");
  gpu::restore(bytes, previous_intensity_);
}

}  // namespace hermite
