// Where a scan may lie in another one, without a guess: candidates for a registration. Pure
// functions.
#pragma once

#include <span>
#include <vector>

#include "core/compare/agreement.h"
#include "core/compare/surface_features.h"
#include "core/math/rigid3.h"

namespace hermite::compare {

// Two candidates are one if they place the middle of the scan within this many spacings of its
// samples, and turn it by less than this.
inline constexpr double kSamePlace = 6, kSameTurn_rad = 0.26;
bool is_same_pose(const Rigid3& a_from_b, const Rigid3& other_a_from_b, const CoarseScan& b);

// Returns candidates by pairs of similar features: draws two pairs, of which each has a place and a
// normal, and counts how many pairs agree with the rigid transform between them (RANSAC). Best
// first, different from each other, at most `most`. Deterministic.
std::vector<Rigid3> poses_by_features(const CoarseScan& a, const CoarseScan& b,
                                      std::span<const FeaturePair> pairs, std::size_t most);

// Returns candidates by planes, for rooms: the 24 rotations that align the main directions of the
// surfaces (floor and walls), each with the shifts along the directions that bring most parallel
// surfaces together. Not ordered.
std::vector<Rigid3> poses_by_planes(const CoarseScan& a, const CoarseScan& b);

// Returns the candidates of which most samples of B have a similar surface of A near, best first,
// different from each other, at most `most`.
std::vector<Rigid3> best_poses(const CoarseScan& a, const CoarseScan& b,
                               std::span<const Rigid3> candidates, std::size_t most);

// The poses that differ from one by a turn of the surface about its own main directions, by 90, 180
// or 270 degrees about its middle: what a symmetric place would be mistaken for.
std::vector<Rigid3> turned_poses(const Rigid3& a_from_b, const CoarseScan& a);

}  // namespace hermite::compare
