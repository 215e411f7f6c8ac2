#include "core/adjust/submap_atlas_fields.h"

#include "core/adjust/feature_fields.h"
#include "core/adjust/submap_fields.h"

namespace hermite::adjust {

namespace {

constexpr std::size_t kMaxSubmaps = 1u << 16;  // the submap index of a surfel has 16 bits

bool is_near(const Eigen::Vector3d& point_m) {
  return point_m.allFinite() && point_m.cwiseAbs().maxCoeff() <= kMaxStoredDistance_m;
}

template <class Bytes, class Saved>
void keyframe_fields(Bytes& bytes, Saved& keyframe) {
  bytes.number(keyframe.frame_index);
  bytes.number(keyframe.submap);
  rigid3_fields(bytes, keyframe.submap_from_camera);
  bytes.list(keyframe.features, [](auto& to, auto& feature) { feature_fields(to, feature); });
}

template <class Bytes, class Saved>
void landmark_fields(Bytes& bytes, Saved& landmark) {
  bytes.number(landmark.submap);
  bytes.numbers(landmark.position_in_submap_m.data(), 3);
  bytes.number(landmark.descriptor);
  bytes.numbers(landmark.observations);
  bytes.require(is_near(landmark.position_in_submap_m), "a landmark's position is out of range");
}

// Sets the landmark of each feature from the observations; a feature may occur only once.
void assign_landmarks(ByteReader& bytes, SparseMap& map) {
  for (Keyframe& keyframe : map.keyframes)
    keyframe.landmark_of_feature.assign(keyframe.features.size(), kNoLandmark);
  for (std::size_t landmark = 0; landmark < map.landmarks.size(); ++landmark) {
    std::int64_t last_keyframe = -1;
    for (const Observation& observation : map.landmarks[landmark].observations) {
      const bool is_there =
          observation.keyframe < map.keyframes.size() && observation.keyframe > last_keyframe &&
          observation.feature < map.keyframes[observation.keyframe].features.size() &&
          map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] ==
              kNoLandmark;
      bytes.require(is_there, "an observation of a landmark is invalid");
      if (!bytes.ok()) return;
      map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] =
          static_cast<std::int32_t>(landmark);
      last_keyframe = observation.keyframe;
    }
  }
}

template <class Bytes, class Saved>
void loss_fields(Bytes& bytes, Saved& loss) {
  bytes.number(loss.before);
  bytes.number(loss.after);
  bytes.numbers(loss.last_place_m.data(), 3);
  bytes.number(loss.reach_m);
  bytes.require(is_near(loss.last_place_m) && loss.reach_m >= 0,
                "how far a lost camera can have come is out of range");
}

void check_map(ByteReader& bytes, const SparseMap& map) {
  const std::size_t submaps = map.world_from_submap.size();
  bytes.require(submaps >= 1 && submaps <= kMaxSubmaps, "the number of submaps is out of range");
  const std::size_t planes = depth_grid_of(map.camera).count();
  for (const Keyframe& keyframe : map.keyframes) {
    bytes.require(keyframe.submap < submaps &&
                      keyframe.features.size() <= static_cast<std::size_t>(kMaxFeatureCount),
                  "a keyframe has an invalid submap or too many features");
    bytes.require(keyframe.planes.empty() || keyframe.planes.size() == planes,
                  "a keyframe has a wrong number of depth planes");
  }
  for (const Landmark& landmark : map.landmarks)
    bytes.require(landmark.submap < submaps, "the submap of a landmark is out of range");
}

void check_graph(ByteReader& bytes, const SubmapGraph& graph, std::size_t submaps,
                 std::uint32_t component_count) {
  bytes.require(graph.component.size() == submaps && graph.parent.size() == submaps &&
                    component_count <= submaps,
                "the graph of submaps has a wrong size");
  bytes.require(all_below(graph.component, component_count) && all_below(graph.parent, submaps),
                "an entry of the submap graph is out of range");
  for (const SubmapLink& link : graph.links)
    bytes.require(link.from < submaps && link.to < submaps, "the ends of a link are out of range");
}

template <class Bytes, class Saved>
void atlas_fields(Bytes& bytes, Saved& atlas) {
  bytes.list(atlas.map.keyframes, [](auto& to, auto& keyframe) { keyframe_fields(to, keyframe); });
  bytes.list(atlas.map.landmarks, [](auto& to, auto& landmark) { landmark_fields(to, landmark); });
  bytes.list(atlas.map.world_from_submap, [](auto& to, auto& pose) { rigid3_fields(to, pose); });
  bytes.numbers(atlas.graph.component);
  bytes.numbers(atlas.graph.parent);
  bytes.list(atlas.graph.links, [](auto& to, auto& link) { link_fields(to, link); });
  bytes.list(atlas.losses, [](auto& to, auto& loss) { loss_fields(to, loss); });
  bytes.flags(atlas.layout.is_active);
  bytes.number(atlas.layout.current);
  bytes.number(atlas.layout.correction_count);
  bytes.number(atlas.layout.closure_count);
  rigid3_fields(bytes, atlas.submap_from_camera);
  bytes.number(atlas.frame);
  bytes.number(atlas.component_count);
  bytes.require(is_stored_index(atlas.frame), "a frame index is out of range");
  for (auto& keyframe : atlas.map.keyframes)
    // The largest share of the bytes; any value is valid, so they come last.
    bytes.numbers(keyframe.planes);
}

}  // namespace

void save(ByteWriter& bytes, const SubmapAtlas& atlas) { atlas_fields(bytes, atlas); }

void restore(ByteReader& bytes, SubmapAtlas& atlas) {
  atlas_fields(bytes, atlas);
  const std::size_t submaps = atlas.map.world_from_submap.size();
  check_map(bytes, atlas.map);
  check_graph(bytes, atlas.graph, submaps, atlas.component_count);
  for (const SightLoss& loss : atlas.losses)
    bytes.require(loss.before < submaps && loss.after < submaps,
                  "the submaps between which the camera was lost are out of range");
  bytes.require(atlas.layout.is_active.size() == submaps && atlas.layout.current < submaps,
                "the current submap is out of range");
  if (bytes.ok()) assign_landmarks(bytes, atlas.map);
  if (bytes.ok()) publish(atlas);
}

}  // namespace hermite::adjust
