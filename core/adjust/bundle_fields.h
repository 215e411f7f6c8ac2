// Serialises a problem of bundle adjustment that was taken from a map, without its camera, in our
// own byte format (core/base/byte_stream.h). Values are not checked: adjust() validates the
// problem, and check_scope() its scope.
#pragma once

#include <algorithm>

#include "core/adjust/bundle_of_map.h"
#include "core/adjust/submap_fields.h"
#include "core/math/rigid3_fields.h"

namespace hermite::adjust {

template <class Bytes, class Saved>
void scope_fields(Bytes& bytes, Saved& scope) {
  bytes.numbers(scope.submaps);
  bytes.numbers(scope.landmarks);
  bytes.numbers(scope.sightings);
}

template <class Bytes, class Saved>
void problem_fields(Bytes& bytes, Saved& problem) {
  bytes.list(problem.world_from_submap, [](auto& to, auto& pose) { rigid3_fields(to, pose); });
  bytes.flags(problem.is_fixed);
  bytes.list(problem.keyframes, [](auto& to, auto& keyframe) {
    to.number(keyframe.submap);
    rigid3_fields(to, keyframe.submap_from_camera);
    to.number(keyframe.weight);
  });
  bytes.list(problem.landmarks_in_world,
             [](auto& to, auto& point) { to.numbers(point.data(), 3); });
  bytes.list(problem.observations, [](auto& to, auto& observation) {
    to.number(observation.keyframe);
    to.number(observation.landmark);
    to.numbers(observation.pixel_px.data(), 2);
    to.number(observation.depth_m);
    to.number(observation.scale);
  });
  bytes.list(problem.links, [](auto& to, auto& link) {
    to.number(link.from);
    to.number(link.to);
    rigid3_fields(to, link.from_from_to);
    to.numbers(link.information.data(), 36);
    to.flag(link.robust);
  });
}

template <class Bytes, class Saved>
void bundle_fields(Bytes& bytes, Saved& bundle) {
  scope_fields(bytes, bundle.scope);
  problem_fields(bytes, bundle.problem);
}

// Fails the reader unless the scope is as long as the problem, and its indices are in the map.
inline void check_scope(ByteReader& bytes, const BundleOfMap& bundle, const SparseMap& map) {
  const BundleScope& scope = bundle.scope;
  const BundleProblem& problem = bundle.problem;
  const std::size_t submaps = map.world_from_submap.size(), landmarks = map.landmarks.size();
  bytes.require(scope.submaps.size() == problem.world_from_submap.size() &&
                    scope.landmarks.size() == problem.landmarks_in_world.size() &&
                    scope.sightings.size() == problem.observations.size(),
                "a running adjustment does not fit the map");
  bytes.require(all_below(scope.submaps, submaps) && all_below(scope.landmarks, landmarks) &&
                    std::all_of(scope.sightings.begin(), scope.sightings.end(),
                                [landmarks](const BundleScope::Sighting& sighting) {
                                  return sighting.landmark < landmarks;
                                }),
                "the scope of a running adjustment is out of range");
}

}  // namespace hermite::adjust
