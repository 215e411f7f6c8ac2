#include "tests/core/adjust/bundle_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/adjust/bundle_noise.h"

namespace hermite::test {

namespace {

constexpr double kWall_m = 2;  // from the camera's way to the wall
// Waviness of way and wall [m or rad]: nothing lies in one plane or circle.
constexpr double kNoise = 0.01;

// Looking outwards at `angle`, its image upright: x along the way, y down, z out.
Rigid3 pose_at(double angle, double circle_m, std::mt19937& random) {
  Eigen::Matrix3d rotation;
  rotation.col(2) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  rotation.col(1) = Eigen::Vector3d(0, 0, -1);
  rotation.col(0) = rotation.col(1).cross(rotation.col(2));
  const Rigid3 level{Eigen::Quaterniond(rotation), circle_m * rotation.col(2)};
  return level * exp_se3(random_twist(random, 10 * kNoise, 10 * kNoise));
}

bool is_seen(const Camera& camera, const Eigen::Vector3d& in_camera) {
  if (in_camera.z() < 0.5 || in_camera.z() > 3.5) return false;
  const Eigen::Vector2d pixel = camera.project(in_camera);
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= camera.width - 1 &&
         pixel.y() <= camera.height - 1;
}

// Landmarks that only one keyframe sees are not worth having: their observations go.
void drop_single_observations(World& world) {
  std::vector<int> counts(world.truth.landmarks_in_world.size());
  for (const adjust::BundleObservation& observation : world.truth.observations)
    counts[observation.landmark] += 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < world.truth.observations.size(); ++i) {
    if (counts[world.truth.observations[i].landmark] < 2) continue;
    world.truth.observations[kept] = world.truth.observations[i];
    world.observation_is_outlier[kept] = world.observation_is_outlier[i];
    kept += 1;
  }
  world.truth.observations.resize(kept);
  world.observation_is_outlier.resize(kept);
}

adjust::BundleObservation measure(const Camera& camera, const Eigen::Vector3d& in_camera,
                                  const WorldOptions& options, std::mt19937& random) {
  adjust::BundleObservation observation;
  observation.scale = std::pow(1.2, static_cast<double>(random() % 4));
  const double u = normal(random), v = normal(random), d = normal(random);
  observation.pixel_px =
      camera.project(in_camera) + options.noise * observation.scale * Eigen::Vector2d(u, v);
  if (options.with_depth)
    observation.depth_m =
        in_camera.z() + options.noise * adjust::depth_deviation_m(in_camera.z()) * d;
  return observation;
}

}  // namespace

double uniform(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1.0; }

double normal(std::mt19937& random) {  // Box and Muller
  const double a = (static_cast<double>(random()) + 1) / 4294967296.0, b = uniform(random) * M_PI;
  return std::sqrt(-2 * std::log(a)) * std::cos(b);
}

Vector6d random_twist(std::mt19937& random, double metres, double radians) {
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = uniform(random) * (i < 3 ? metres : radians);
  return twist;
}

World make_world(const WorldOptions& options) {
  std::mt19937 random(options.seed);
  World world;
  adjust::BundleProblem& truth = world.truth;
  truth.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  const int keyframe_count = options.submap_count * options.keyframes_per_submap;
  std::vector<Rigid3> world_from_camera;
  for (int i = 0; i < keyframe_count; ++i) {
    world_from_camera.push_back(
        pose_at(2 * M_PI * options.laps * i / keyframe_count, options.circle_m, random));
    if (i % options.keyframes_per_submap == 0)
      truth.world_from_submap.push_back(world_from_camera.back());
    truth.keyframes.push_back({static_cast<std::uint32_t>(i / options.keyframes_per_submap),
                               inverse(truth.world_from_submap.back()) * world_from_camera.back()});
  }
  truth.is_fixed.assign(truth.world_from_submap.size(), false);
  truth.is_fixed[0] = true;
  for (int i = 0; i < options.landmark_count; ++i) {
    const double angle = M_PI * uniform(random),
                 out_m = options.circle_m + kWall_m + 0.5 * uniform(random);
    truth.landmarks_in_world.push_back(
        {out_m * std::cos(angle), out_m * std::sin(angle), 0.8 * uniform(random)});
  }
  for (int k = 0; k < keyframe_count; ++k) {
    const Rigid3 camera_from_world = inverse(world_from_camera[static_cast<std::size_t>(k)]);
    for (std::uint32_t i = 0; i < truth.landmarks_in_world.size(); ++i) {
      const Eigen::Vector3d in_camera = camera_from_world * truth.landmarks_in_world[i];
      if (!is_seen(truth.camera, in_camera)) continue;
      adjust::BundleObservation observation = measure(truth.camera, in_camera, options, random);
      observation.keyframe = static_cast<std::uint32_t>(k);
      observation.landmark = i;
      const bool is_outlier = 0.5 + 0.5 * uniform(random) < options.outliers;
      if (is_outlier) {
        observation.pixel_px = {320 + 320 * uniform(random), 240 + 240 * uniform(random)};
        if (options.with_depth) observation.depth_m = 2 + 1.5 * uniform(random);
      }
      truth.observations.push_back(observation);
      world.observation_is_outlier.push_back(is_outlier);
    }
  }
  drop_single_observations(world);
  return world;
}

adjust::BundleProblem disturbed(const adjust::BundleProblem& truth, double metres, double radians,
                                double landmark_m, unsigned seed) {
  std::mt19937 random(seed);
  adjust::BundleProblem problem = truth;
  for (std::size_t i = 0; i < problem.world_from_submap.size(); ++i) {
    const Vector6d twist = random_twist(random, metres, radians);
    if (!problem.is_fixed[i])
      problem.world_from_submap[i] = problem.world_from_submap[i] * exp_se3(twist);
  }
  for (Eigen::Vector3d& landmark : problem.landmarks_in_world)
    landmark += random_twist(random, landmark_m, 0).head<3>();
  return problem;
}

Ring make_ring(int submap_count, double deviation_m, double deviation_rad, unsigned seed) {
  std::mt19937 random(seed);
  Ring ring;
  for (int i = 0; i < submap_count; ++i)
    ring.truth.push_back(pose_at(2 * M_PI * i / submap_count, 5, random));
  ring.drifted.is_fixed.assign(ring.truth.size(), false);
  ring.drifted.is_fixed[0] = true;
  ring.drifted.world_from_submap.push_back(ring.truth[0]);
  for (std::uint32_t i = 1; i < ring.truth.size(); ++i) {
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = (k < 3 ? deviation_m : deviation_rad) * normal(random);
    const Rigid3 measured = inverse(ring.truth[i - 1]) * ring.truth[i] * exp_se3(error);
    ring.drifted.links.push_back(
        {i - 1, i, measured, information_of(deviation_m, deviation_rad), false});
    ring.drifted.world_from_submap.push_back(ring.drifted.world_from_submap.back() * measured);
  }
  const std::uint32_t last = static_cast<std::uint32_t>(ring.truth.size()) - 1;
  ring.drifted.links.push_back({last, 0, inverse(ring.truth[last]) * ring.truth[0],
                                information_of(deviation_m, deviation_rad), true});
  return ring;
}

Matrix6d information_of(double deviation_m, double deviation_rad) {
  Vector6d diagonal;
  diagonal.head<3>().setConstant(1 / (deviation_m * deviation_m));
  diagonal.tail<3>().setConstant(1 / (deviation_rad * deviation_rad));
  return diagonal.asDiagonal();
}

double largest_distance_m(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i].translation - b[i].translation).norm());
  return largest;
}

double largest_angle_rad(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, angle_rad(a[i].rotation.conjugate() * b[i].rotation));
  return largest;
}

double rms_distance_m(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i].translation - b[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

bool same_bits(const Rigid3& a, const Rigid3& b) {
  return std::memcmp(a.rotation.coeffs().data(), b.rotation.coeffs().data(), 4 * sizeof(double)) ==
             0 &&
         std::memcmp(a.translation.data(), b.translation.data(), 3 * sizeof(double)) == 0;
}

}  // namespace hermite::test
