// A world of points with descriptors, and what a camera in it would detect: features whose
// landmarks are known. Header only.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/sparse_map.h"

namespace hermite::test {

inline Camera point_camera() { return {640, 480, 525, 525, 319.5, 239.5, 5000, {}}; }

inline adjust::Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

inline adjust::Descriptor with_flipped_bits(adjust::Descriptor descriptor, int count,
                                            std::mt19937_64& random) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bit = random() % adjust::kDescriptorBits;
    descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

inline double normal(std::mt19937_64& random) {
  return std::sqrt(-2 * std::log((static_cast<double>(random() >> 11) + 1) * 0x1p-53)) *
         std::cos(2 * M_PI * static_cast<double>(random() >> 11) * 0x1p-53);
}

struct WorldPoint {
  Eigen::Vector3d position_m;
  Eigen::Vector3d brighter;  // unit, to its brighter side
  double size_m;             // of what is a pixel of octave 0 at the right distance
  adjust::Descriptor descriptor;
};

struct View {
  std::vector<adjust::Feature> features;
  std::vector<std::size_t> point_of_feature;
};

struct ViewNoise {
  double pixel_px = 0;      // times 1.2^octave
  double depth_sigmas = 0;  // of depth_deviation_m
  int flipped_bits = 0;     // at most, of each descriptor
};
inline constexpr ViewNoise kViewNoise{0.5, 1, 30};  // of a common camera

// The walls of a room of 6 x 6 m, 3 m high, with a camera near its centre that looks about.
struct PointWorld {
  std::vector<WorldPoint> points;

  explicit PointWorld(std::size_t count, std::uint64_t seed = 1) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    for (std::size_t i = 0; i < count; ++i) {
      const double along = uniform(-3, 3), up = uniform(-1.5, 1.5);
      const std::array<Eigen::Vector3d, 4> walls{
          {{along, up, 3}, {3, up, along}, {along, up, -3}, {-3, up, along}}};
      const Eigen::Vector3d direction =
          Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
      points.push_back({walls[i % 4], direction,
                        0.005 * std::pow(adjust::kOctaveScale, uniform(0, 4)),
                        random_descriptor(random)});
    }
  }

  View view(const Rigid3& world_from_camera, const ViewNoise& noise = {},
            std::uint64_t seed = 1) const {
    std::mt19937_64 random(seed);
    const Camera camera = point_camera();
    const Rigid3 camera_from_world = inverse(world_from_camera);
    View seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d at = camera_from_world * points[i].position_m;
      if (at.z() < adjust::kMinFeatureDepth_m || at.z() > adjust::kMaxFeatureDepth_m) continue;
      const Eigen::Vector2d pixel_px = camera.project(at);
      if (pixel_px.x() < 20 || pixel_px.y() < 20 || pixel_px.x() > camera.width - 21 ||
          pixel_px.y() > camera.height - 21)
        continue;
      const double octave =
          std::log(points[i].size_m * camera.fx / at.z()) / std::log(adjust::kOctaveScale);
      adjust::Feature feature;
      feature.octave = static_cast<std::uint8_t>(
          std::clamp(std::lround(octave), 0L, static_cast<long>(adjust::kOctaveCount - 1)));
      const double sigma_px = noise.pixel_px * adjust::octave_scale(feature.octave);
      feature.pixel_px =
          (pixel_px + sigma_px * Eigen::Vector2d(normal(random), normal(random))).cast<float>();
      feature.depth_m = static_cast<float>(
          at.z() + noise.depth_sigmas * adjust::depth_deviation_m(at.z()) * normal(random));
      const Eigen::Vector3d brighter = camera_from_world.rotation * points[i].brighter;
      const Eigen::Vector2d slope = brighter.head<2>() * at.z() - at.head<2>() * brighter.z();
      feature.angle_rad = static_cast<float>(std::atan2(slope.y(), slope.x()));
      feature.descriptor = with_flipped_bits(points[i].descriptor, noise.flipped_bits, random);
      seen.features.push_back(feature);
      seen.point_of_feature.push_back(i);
    }
    return seen;
  }
};

// Turned by `yaw_deg` about the vertical, moved by `shift_m` to its right.
inline Rigid3 looking(double yaw_deg, double shift_m = 0) {
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(yaw_deg * M_PI / 180, Eigen::Vector3d::UnitY()));
  return {rotation, rotation * Eigen::Vector3d(shift_m, 0, 0)};
}

inline adjust::SparseMap empty_map() { return {point_camera(), {}, {}, {Rigid3()}}; }

inline adjust::Keyframe keyframe_of(const View& view, const Rigid3& submap_from_camera,
                                    std::uint32_t submap = 0) {
  adjust::Keyframe keyframe;
  keyframe.submap = submap;
  keyframe.submap_from_camera = submap_from_camera;
  keyframe.features = view.features;
  return keyframe;
}

}  // namespace hermite::test
