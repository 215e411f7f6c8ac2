#include "core/track/own_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/frame/frame_options.h"

namespace hermite::track {

namespace {

// Share of the visible area in square metres; above it, it is unknown which part is the room. A
// person in front of the camera may cover most of the view, but a room has more surface than a
// person.
constexpr double kMostMoving = 0.4;

// Limits for pairs: distance, and cosine between normals. Following the wrong object turns the
// camera so that far surfaces move by up to 15 cm.
constexpr double kNear_m = 0.15, kAlikeCosine = 0.8;
constexpr int kLeastPairs = 20;

// As in the odometry (shaders/track/odometry.comp): Student's t distribution for both residuals,
// and errors by pixels and edges.
constexpr double kDegreesOfFreedom = 5, kSaturated = 250, kBlur2 = 0.15 * 0.15;
// Deviations and grey values: robust to motion, and above any noise.
constexpr double kGeometricStart = 3, kPhotometricStart = 10;
constexpr double kLeastGeometric = 0.1, kLeastPhotometric = 1;

// Prior for directions that the pairs do not determine: an object moves by a decimetre or a tenth
// of a radian between two views.
constexpr double kPriorInformation = 1 / (0.1 * 0.1);

// Gauss-Newton steps from the tracked pose, and if the room may have moved differently.
constexpr int kSteps = 2, kStepsWhenMoving = 6;

// A surface is suspicious if its chi-square with 6 degrees of freedom (median 5.35) exceeds any
// noise, and exceeds this many times the usual value of surfaces of this scan. The first-order
// value is less than the final one, so the limit is lower than that for a motion. A surface moves
// if the chi-square of its own motion is this many times the median of the other surfaces: noise is
// correlated over pixels and lenses bend depth, which affects all of them alike. Its motion must
// also be this share of its displacement by the camera, since rolling shutters and late images
// shift what is seen by a part of that. Where nothing moves (250 frames of redkitchen, fr1, the
// rendered room with depth bent by 1.5 %; views 4 and 30 frames apart) one surface in a thousand
// has 375 and 0.39, in fr1 637 and 0.25; a person who walks ahead has 490 to 3500 and 0.45 to 0.9
// after the first step. A surface that moved rests again once it is below either lower limit.
constexpr double kMedianChi2 = 5.35, kSuspicious = 60;
constexpr double kMoves = 400, kStillMoves = 60;
constexpr double kShareOfCamera = 0.4, kStillShareOfCamera = 0.1;

// The most suspicious surfaces, each of which is left out in turn.
constexpr std::size_t kTried = 3;

// Half the quadratic form of a twist that moves a surface's points.
struct System {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d right_hand_side = Vector6d::Zero();
  int pairs = 0;

  void add(const Vector6d& row, double residual, double weight) {
    const Vector6d weighted = weight * row;
    for (int column = 0; column < 6; ++column) hessian.col(column) += weighted * row[column];
    right_hand_side.noalias() -= residual * weighted;
  }
};

// Scales of the residuals, and the frame's brightness relative to the earlier view's; updated in
// each step from resting surfaces.
struct Believed {
  double geometric = kGeometricStart, photometric = kPhotometricStart;
  double gain = 1, offset = 0;
};

// Before pairs are known, both views are taken to have the same mean brightness.
Believed believed_at_first(const frame::CoarseView& frame, const frame::CoarseView& earlier) {
  const auto mean = [](const frame::CoarseView& view) {
    double sum = 0;
    for (const float grey : view.grey) sum += std::clamp(double{grey}, 1.0, 255.0);
    return sum / static_cast<double>(view.size());
  };
  Believed believed;
  believed.gain = std::clamp(mean(frame) / mean(earlier), 0.5, 2.0);
  return believed;
}

struct Sums {
  double count = 0, weighted = 0;
  double deviation() const { return std::sqrt(weighted / count); }
};

// Sums for the line grey = gain * known + offset.
struct Line {
  double one = 0, known = 0, known2 = 0, grey = 0, known_grey = 0;
};

// A pixel of the frame that can be paired, as every linearisation needs it.
struct FramePixel {
  Eigen::Vector3d point, normal;
  Eigen::Vector2d uv, gradient;  // `gradient` in grey values per pixel
  double grey = -1;              // negative: no gradient, or saturated
};

// Pixels of the frame by surface: those of surface `s` are first_of_surface[s] to
// first_of_surface[s + 1].
struct FramePixels {
  std::vector<FramePixel> pixels;
  std::vector<std::size_t> first_of_surface;
};

FramePixel frame_pixel(const frame::CoarseView& frame, int x, int y) {
  const std::size_t i = frame.index(x, y);
  FramePixel pixel;
  pixel.point = frame.point(x, y);
  pixel.normal = frame.normals[i].cast<double>();
  pixel.uv = {x, y};
  const float left = frame.grey[i - 1], right = frame.grey[i + 1];
  const float above = frame.grey[frame.index(x, y - 1)], below = frame.grey[frame.index(x, y + 1)];
  pixel.gradient = {0.5 * (double{right} - double{left}), 0.5 * (double{below} - double{above})};
  const bool is_seen =
      std::min({left, right, above, below}) >= 0 && double{frame.grey[i]} <= kSaturated;
  pixel.grey = is_seen ? double{frame.grey[i]} : -1;
  return pixel;
}

FramePixels by_surface(const frame::CoarseView& frame, const ViewSurfaces& surfaces) {
  const int width = static_cast<int>(frame.camera.width),
            height = static_cast<int>(frame.camera.height);
  const auto for_each = [&](auto&& use) {
    for (int y = 1; y + 1 < height; ++y)
      for (int x = 1; x + 1 < width; ++x)
        if (frame.depth_m[frame.index(x, y)] > 0) use(x, y, surfaces.of_pixel[frame.index(x, y)]);
  };
  FramePixels result{{}, std::vector<std::size_t>(surfaces.pixel_count.size() + 1, 0)};
  for_each([&](int, int, std::uint32_t surface) { ++result.first_of_surface[surface + 1]; });
  std::partial_sum(result.first_of_surface.begin(), result.first_of_surface.end(),
                   result.first_of_surface.begin());
  result.pixels.resize(result.first_of_surface.back());
  std::vector<std::size_t> next = result.first_of_surface;
  for_each([&](int x, int y, std::uint32_t surface) {
    result.pixels[next[surface]++] = frame_pixel(frame, x, y);
  });
  return result;
}

// The earlier view, with its points and normals as every linearisation needs them.
struct EarlierPixels {
  const frame::CoarseView& view;
  std::vector<Eigen::Vector3d> points, normals;  // row major; of pixels that have a depth

  explicit EarlierPixels(const frame::CoarseView& earlier)
      : view(earlier), points(frame::points_of(earlier)), normals(earlier.size()) {
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = view.normals[i].cast<double>();
  }

  // Returns the bilinear grey value; negative if it is outside or touches a pixel without a
  // surface.
  double grey_at(double u, double v) const {
    const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
    if (!view.contains(x, y) || !view.contains(x + 1, y + 1)) return -1;
    const double a = u - x, b = v - y;
    const float* above = &view.grey[view.index(x, y)];
    const float* below = above + view.camera.width;
    if (std::min({above[0], above[1], below[0], below[1]}) < 0) return -1;
    return (1 - b) * ((1 - a) * double{above[0]} + a * double{above[1]}) +
           b * ((1 - a) * double{below[0]} + a * double{below[1]});
  }
};

// The motion of one surface relative to the others.
struct Apart {
  bool is_known = false;
  double chi2 = 0, share_of_camera = 0;
  bool is_beyond(double least_chi2, double least_share) const {
    return is_known && chi2 > least_chi2 && share_of_camera > least_share;
  }
};

// Robust sums over resting surfaces, for the scales and the brightness of the next step.
struct Spread {
  Sums geometric, photometric;
  Line line;
};

// A rigid transform whose rotation is a matrix, which is applied to a pixel faster than a
// quaternion.
struct Placement {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

struct Comparison {
  FramePixels frame;
  EarlierPixels earlier;
  CameraMotion motion;

  std::size_t surface_count() const { return frame.first_of_surface.size() - 1; }
  void add(const FramePixel& pixel, const Placement& earlier_from_frame, const Believed& believed,
           System& system, Spread& spread) const;
  std::vector<System> linearise(const Rigid3& earlier_from_frame, const std::vector<bool>& moves,
                                Believed& believed) const;
  Rigid3 align(Rigid3 earlier_from_frame, const std::vector<bool>& moves, int steps,
               Believed& believed, std::vector<System>& systems) const;
  Apart apart(std::size_t surface, const Rigid3& rest_pose, const System& rest,
              Believed believed) const;
};

// Adds the pair of the pixel, if it has one.
void Comparison::add(const FramePixel& pixel, const Placement& earlier_from_frame,
                     const Believed& believed, System& system, Spread& spread) const {
  const auto& [rotation, translation] = earlier_from_frame;
  const shared::Intrinsics& camera = earlier.view.camera;
  const double fx = double{camera.fx}, fy = double{camera.fy};
  const Eigen::Vector3d point = rotation * pixel.point + translation;
  if (point.z() < 0.05) return;
  const double per_z = 1 / point.z(), u = fx * point.x() * per_z + double{camera.cx},
               v = fy * point.y() * per_z + double{camera.cy};
  const int x = static_cast<int>(std::floor(u + 0.5)), y = static_cast<int>(std::floor(v + 0.5));
  if (!earlier.view.contains(x, y)) return;
  const std::size_t j = earlier.view.index(x, y);
  if (earlier.view.depth_m[j] <= 0) return;
  const Eigen::Vector3d &normal = earlier.normals[j], away = point - earlier.points[j];
  if (away.squaredNorm() > kNear_m * kNear_m || normal.dot(rotation * pixel.normal) < kAlikeCosine)
    return;
  const double per_noise = 1 / frame::kinect_noise_m(point.z());
  Vector6d row;
  row.head<3>() = per_noise * normal;
  row.tail<3>() = per_noise * point.cross(normal);
  const double residual = per_noise * normal.dot(away), scaled = residual / believed.geometric;
  const double likely = kDegreesOfFreedom / (kDegreesOfFreedom + scaled * scaled);
  system.add(row, residual, likely / (believed.geometric * believed.geometric));
  ++system.pairs;
  spread.geometric.count += 1;
  spread.geometric.weighted += likely * residual * residual;
  if (pixel.grey < 0 || std::abs(scaled) > 3) return;
  const double known = earlier.grey_at(u, v);
  if (known < 0 || known > kSaturated) return;
  const double flow =
      pixel.gradient.x() * (u - pixel.uv.x()) + pixel.gradient.y() * (v - pixel.uv.y());
  const double expected2 = 1 + kBlur2 * pixel.gradient.squaredNorm() + 0.09 * flow * flow,
               misfit = pixel.grey - (believed.gain * known + believed.offset);
  const double per_expected2 = 1 / (expected2 * believed.photometric * believed.photometric);
  const double grey_likely =
                   kDegreesOfFreedom / (kDegreesOfFreedom + misfit * misfit * per_expected2),
               weight = grey_likely * per_expected2;
  const double per_x = pixel.gradient.x() * fx * per_z, per_y = pixel.gradient.y() * fy * per_z;
  const Eigen::Vector3d slope(-per_x, -per_y, (per_x * point.x() + per_y * point.y()) * per_z);
  row.head<3>() = slope;
  row.tail<3>() = point.cross(slope);
  system.add(row, misfit, weight);
  spread.photometric.count += 1;
  spread.photometric.weighted += grey_likely * misfit * misfit / expected2;
  Line& line = spread.line;
  line.one += weight, line.known += weight * known, line.known2 += weight * known * known;
  line.grey += weight * pixel.grey, line.known_grey += weight * known * pixel.grey;
}

// Returns systems by surface; scales and brightness are updated from the resting ones.
std::vector<System> Comparison::linearise(const Rigid3& earlier_from_frame,
                                          const std::vector<bool>& moves,
                                          Believed& believed) const {
  std::vector<System> systems(surface_count());
  Spread spread;
  const Placement placement{earlier_from_frame.rotation.toRotationMatrix(),
                            earlier_from_frame.translation};
  for (std::size_t surface = 0; surface < systems.size(); ++surface) {
    if (moves[surface]) continue;
    for (std::size_t i = frame.first_of_surface[surface]; i < frame.first_of_surface[surface + 1];
         ++i)
      add(frame.pixels[i], placement, believed, systems[surface], spread);
  }
  const auto& [geometric, photometric, line] = spread;
  // Scales only decrease: the first ones are wider than any noise.
  if (geometric.count > 0)
    believed.geometric = std::clamp(geometric.deviation(), kLeastGeometric, believed.geometric);
  if (photometric.count > 0)
    believed.photometric =
        std::clamp(photometric.deviation(), kLeastPhotometric, believed.photometric);
  const double spread2 = line.one * line.known2 - line.known * line.known;
  if (spread2 > 1e-3 * line.one * line.one) {
    believed.gain =
        std::clamp((line.one * line.known_grey - line.known * line.grey) / spread2, 0.5, 2.0);
    believed.offset = (line.grey - believed.gain * line.known) / line.one;
  }
  return systems;
}

System sum_of_resting(const std::vector<System>& systems, const std::vector<bool>& moves) {
  System sum;
  sum.hessian = kPriorInformation * Matrix6d::Identity();
  for (std::size_t surface = 0; surface < systems.size(); ++surface) {
    if (moves[surface]) continue;
    sum.hessian += systems[surface].hessian;
    sum.right_hand_side += systems[surface].right_hand_side;
  }
  return sum;
}

// Aligns the resting surfaces; `systems` are those of the last linearisation.
Rigid3 Comparison::align(Rigid3 earlier_from_frame, const std::vector<bool>& moves, int steps,
                         Believed& believed, std::vector<System>& systems) const {
  for (int step = 0; step < steps; ++step) {
    const System rest = sum_of_resting(linearise(earlier_from_frame, moves, believed), moves);
    earlier_from_frame =
        exp_se3(rest.hessian.ldlt().solve(rest.right_hand_side)) * earlier_from_frame;
  }
  systems = linearise(earlier_from_frame, moves, believed);
  return earlier_from_frame;
}

// Returns, by surface, the first-order chi-square of its own motion against that of the others; 0:
// too few pairs.
std::vector<double> suspicions(const std::vector<System>& systems, const std::vector<bool>& moves) {
  std::vector<double> chi2(systems.size(), 0);
  const System all = sum_of_resting(systems, moves);
  for (std::size_t surface = 1; surface < systems.size(); ++surface) {
    const System& own = systems[surface];
    if (own.pairs < kLeastPairs || moves[surface]) continue;
    const auto own_factor = (own.hessian + kPriorInformation * Matrix6d::Identity()).eval().ldlt();
    const auto rest_factor = (all.hessian - own.hessian).eval().ldlt();
    const Vector6d apart = own_factor.solve(own.right_hand_side) -
                           rest_factor.solve(all.right_hand_side - own.right_hand_side);
    const Matrix6d covariance =
        own_factor.solve(Matrix6d::Identity()) + rest_factor.solve(Matrix6d::Identity());
    chi2[surface] = apart.dot(covariance.ldlt().solve(apart));
  }
  return chi2;
}

// Returns by how much the chi-squares of resting surfaces exceed those of independent noise.
double disagreement(const std::vector<System>& systems, const std::vector<bool>& moves) {
  std::vector<double> chi2 = suspicions(systems, moves);
  std::erase(chi2, 0);
  if (chi2.empty()) return 1;
  const auto middle = chi2.begin() + static_cast<std::ptrdiff_t>(chi2.size() / 2);
  std::nth_element(chi2.begin(), middle, chi2.end());
  return std::max(1.0, *middle / kMedianChi2);
}

Apart Comparison::apart(std::size_t surface, const Rigid3& rest_pose, const System& rest,
                        Believed believed) const {
  std::vector<bool> others(surface_count(), true);
  others[surface] = false;
  std::vector<System> systems;
  const Rigid3 own_pose = align(rest_pose, others, kStepsWhenMoving, believed, systems);
  const System& own = systems[surface];
  if (own.pairs < kLeastPairs) return {};
  const Matrix6d prior = kPriorInformation * Matrix6d::Identity();
  const Vector6d twist = log_se3(own_pose * inverse(rest_pose));
  const Matrix6d covariance = (own.hessian + prior).inverse() + rest.hessian.inverse();
  // Returns how far a twist moves the points, as far as the residuals show it.
  const auto length = [&own](const Vector6d& x) { return std::sqrt(x.dot(own.hessian * x)); };
  const double by_camera = length(log_se3(rest_pose)) + length(motion.step_before_earlier) +
                           length(motion.step_before_frame);
  return {true, twist.dot(covariance.ldlt().solve(twist)),
          length(twist) / std::max(by_camera, 1e-9)};
}

// Returns areas by surface: the area that a pixel covers grows with the square of its distance.
std::vector<double> areas_of(const frame::CoarseView& frame, const ViewSurfaces& surfaces) {
  std::vector<double> areas(surfaces.pixel_count.size(), 0);
  for (std::size_t i = 0; i < frame.size(); ++i)
    areas[surfaces.of_pixel[i]] += double{frame.depth_m[i]} * double{frame.depth_m[i]};
  return areas;
}

}  // namespace

OwnMotions own_motions(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
                       const frame::CoarseView& earlier, const CameraMotion& motion,
                       const SurfaceExperience& experience) {
  const Comparison comparison{by_surface(frame, surfaces), EarlierPixels(earlier), motion};
  const std::vector<double> area = areas_of(frame, surfaces);
  const auto is_most = [&area](const std::vector<bool>& moves) {
    double moving = 0;
    for (std::size_t surface = 1; surface < moves.size(); ++surface)
      moving += moves[surface] ? area[surface] : 0;
    return moving > kMostMoving * std::accumulate(area.begin(), area.end(), 0.0);
  };
  struct State {
    std::vector<bool> moves;
    Rigid3 pose;
    Believed believed;
    std::vector<System> systems;
  } state{
      experience.moved_before, motion.earlier_from_frame, believed_at_first(frame, earlier), {}};
  if (is_most(state.moves)) state.moves.assign(state.moves.size(), false);
  state.pose = comparison.align(state.pose, state.moves, kSteps, state.believed, state.systems);
  const auto without = [&](std::size_t surface) {
    State result{state.moves, state.pose, believed_at_first(frame, earlier), {}};
    result.moves[surface] = true;
    result.pose = comparison.align(state.pose, result.moves, kStepsWhenMoving, result.believed,
                                   result.systems);
    return result;
  };
  const auto apart = [&](const State& of, std::size_t surface) {
    Apart apart =
        comparison.apart(surface, of.pose, sum_of_resting(of.systems, of.moves), of.believed);
    apart.chi2 /= std::max(experience.usual_disagreement, disagreement(of.systems, of.moves));
    return apart;
  };
  // Finds one moving surface after the other.
  bool is_divided = false;
  for (bool found = true; found;) {
    found = is_divided = false;
    const std::vector<double> chi2 = suspicions(state.systems, state.moves);
    std::vector<std::size_t> suspects;
    for (std::size_t surface = 1; surface < chi2.size(); ++surface)
      if (chi2[surface] > kSuspicious * experience.usual_disagreement) suspects.push_back(surface);
    std::sort(suspects.begin(), suspects.end(),
              [&chi2](std::size_t a, std::size_t b) { return chi2[a] > chi2[b]; });
    if (suspects.size() > kTried) suspects.resize(kTried);
    State best;
    double most = 0;
    for (const std::size_t suspect : suspects) {
      State trial = without(suspect);
      const Apart alone = apart(trial, suspect);
      if (!alone.is_beyond(kMoves, kShareOfCamera)) continue;
      is_divided = is_divided || is_most(trial.moves);
      if (is_most(trial.moves) || alone.chi2 <= most) continue;
      most = alone.chi2;
      best = std::move(trial);
      found = true;
    }
    if (found) state = std::move(best);
  }
  OwnMotions result{std::vector<OwnMotion>(state.moves.size(), OwnMotion::kUnknown),
                    disagreement(state.systems, state.moves), is_divided};
  for (std::size_t surface = 1; surface < state.moves.size(); ++surface) {
    const Apart alone = state.moves[surface] ? apart(state, surface)
                                             : Apart{state.systems[surface].pairs >= kLeastPairs};
    if (!alone.is_known) continue;
    result.of_surface[surface] =
        alone.is_beyond(kStillMoves, kStillShareOfCamera) ? OwnMotion::kMoves : OwnMotion::kRests;
  }
  return result;
}

}  // namespace hermite::track
