#include "core/adjust/place_search.h"

#include "core/adjust/recognise.h"
#include "core/adjust/repetition.h"
#include "core/adjust/submap_fields.h"

namespace hermite::adjust {

namespace {

// Near submaps are candidates once per this many keyframes, because a verification costs as much as
// a frame.
constexpr std::int64_t kNearInterval = 4;

// The largest number of recognised places that become candidates.
constexpr std::size_t kPlaces = 2;

// Returns whether the first place is unambiguous; `places` are best first.
bool is_unmistakable(const std::vector<PlaceMatch>& places) {
  return places.size() < 2 || static_cast<double>(places[1].matches.size()) <
                                  kAmbiguousShare * static_cast<double>(places[0].matches.size());
}

}  // namespace

void PlaceSearch::add(const SparseMap& map, const std::vector<std::uint32_t>& landmarks) {
  for (const std::uint32_t landmark : landmarks)
    index_.add(landmark, map.landmarks[landmark].descriptor);
}

std::vector<LoopCandidate> PlaceSearch::recognised(const SubmapAtlas& atlas,
                                                   const std::vector<Feature>& features,
                                                   MappingCounts& counts) const {
  const SparseMap& map = atlas.map;
  const std::vector<std::uint32_t>& component = atlas.graph.component;
  std::vector<std::uint32_t> excluded;
  for (std::uint32_t i = 0; i < map.keyframes.size(); ++i)
    if (atlas.layout.is_active[map.keyframes[i].submap]) excluded.push_back(i);
  if (excluded.size() == map.keyframes.size()) return {};
  const std::vector<PlaceMatch> places = recognise(map, index_, features, excluded);
  const std::vector<double> way_m = distances_m(atlas.graph, atlas.layout.current);
  std::vector<LoopCandidate> candidates;
  for (const PlaceMatch& place : places) {
    const Rigid3 there = map.world_from_submap[place.submap] * place.submap_from_camera;
    const bool same_component = component[place.submap] == component[atlas.layout.current];
    // For another component only the appearance is known, so it must be unambiguous.
    const bool possible =
        same_component
            ? is_possible_drift(inverse(world_from_camera(atlas)) * there, way_m[place.submap])
            : is_unmistakable(places);
    if (!possible) ++counts.impossible_places;
    if (possible) candidates.push_back(candidate_at(atlas, there, place.submap, true));
    if (candidates.size() == kPlaces) break;
  }
  return candidates;
}

std::vector<LoopCandidate> PlaceSearch::near(const SubmapAtlas& atlas) {
  const auto keyframe = static_cast<std::int64_t>(atlas.map.keyframes.size());
  if (keyframe < offered_at_keyframe_ + kNearInterval) return {};
  const std::vector<std::uint32_t> near = keyframes_in_view(atlas, false);
  if (near.empty()) return {};
  offered_at_keyframe_ = keyframe;
  return {candidate_at(atlas, world_from_camera(atlas), atlas.map.keyframes[near.front()].submap,
                       false)};
}

std::vector<LoopCandidate> PlaceSearch::relocalise(const SubmapAtlas& atlas,
                                                   const std::vector<Feature>& features,
                                                   MappingCounts& counts) const {
  const std::vector<PlaceMatch> places = recognise(atlas.map, index_, features);
  if (places.empty()) return {};
  if (!is_unmistakable(places)) {
    ++counts.ambiguous_places;
    return {};
  }
  const Rigid3 there = atlas.map.world_from_submap[places[0].submap] * places[0].submap_from_camera;
  return {{there, submaps_in_view(atlas, there, atlas.graph.component[places[0].submap]), true}};
}

bool PlaceSearch::is_distinctive(const SparseMap& map, const std::vector<Feature>& features,
                                 const Rigid3& world_from_camera,
                                 std::int64_t known_keyframes) const {
  return adjust::is_distinctive(
      repetition_of(map, index_, features, world_from_camera, known_keyframes));
}

void PlaceSearch::save(ByteWriter& bytes) const {
  bytes.number(offered_at_keyframe_);
  index_.save(bytes);
}

void PlaceSearch::restore(ByteReader& bytes, std::size_t landmark_count) {
  bytes.number(offered_at_keyframe_);
  bytes.require(is_stored_index(offered_at_keyframe_), "the index of a keyframe is out of range");
  index_.restore(bytes, landmark_count);
}

}  // namespace hermite::adjust
