// Worlds to adjust, made by code: a camera that goes round a circle and looks outwards at a round
// wall with landmarks on it. Submaps are some keyframes in a row; a submap's frame is its first
// camera. Everything about the truth is known.
#pragma once

#include <random>

#include "core/adjust/bundle.h"

namespace hermite::test {

// Uniform in [-1, 1) and standard normal, by our own mapping: the standard's distributions differ
// between libraries.
double uniform(std::mt19937& random);
double normal(std::mt19937& random);
// Every entry within those bounds.
Vector6d random_twist(std::mt19937& random, double metres, double radians);

struct WorldOptions {
  int submap_count = 10;
  int keyframes_per_submap = 4;
  int landmark_count = 400;
  double circle_m = 1;  // radius of the camera's way; the wall is 2 m further out
  double laps = 1;      // with more than one, places are seen again by other submaps
  double noise = 0;     // of pixels and depths, in their standard deviations
  double outliers = 0;  // part of the observations: pixel and depth are then anything
  bool with_depth = true;
  unsigned seed = 1;
};

struct World {
  // True poses and landmarks, measured observations, submap 0 fixed, no links.
  adjust::BundleProblem truth;
  std::vector<bool> observation_is_outlier;
};

World make_world(const WorldOptions& options);

// Moves everything that is free: submaps by a random twist, landmarks by a random step.
adjust::BundleProblem disturbed(const adjust::BundleProblem& truth, double metres, double radians,
                                double landmark_m, unsigned seed);

// A pose graph: that many submaps round a circle of 5 m, neighbours linked by what a dense tracker
// with those deviations would measure, the last one linked to the first, exactly, as the last link.
// Poses are composed from the links, so the ring does not close.
struct Ring {
  std::vector<Rigid3> truth;
  adjust::BundleProblem drifted;
};
Ring make_ring(int submap_count, double deviation_m, double deviation_rad, unsigned seed);

// Of a link with those deviations.
Matrix6d information_of(double deviation_m, double deviation_rad);

// Largest distance of positions [m], and angle between rotations [rad].
double largest_distance_m(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b);
double largest_angle_rad(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b);
double rms_distance_m(const std::vector<Rigid3>& a, const std::vector<Rigid3>& b);

bool same_bits(const Rigid3& a, const Rigid3& b);

}  // namespace hermite::test
