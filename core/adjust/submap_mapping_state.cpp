// Serialisation of SubmapMapping. Derived values are left out: the landmark of each feature, the
// tables of the place index, and the result of a running adjustment, which its problem gives again.
#include <algorithm>
#include <cmath>

#include "core/adjust/feature_fields.h"
#include "core/adjust/submap_mapping.h"
#include "core/math/rigid3_fields.h"

namespace hermite {

namespace {

// No frame or keyframe index is this large; sums of allowed values do not overflow.
constexpr std::int64_t kMaxIndex = std::int64_t{1} << 40;
constexpr std::size_t kMaxSubmaps = 1u << 16;  // the submap index of a surfel has 16 bits

bool is_index(std::int64_t index) { return index >= -kMaxIndex && index <= kMaxIndex; }

bool is_near(const Eigen::Vector3d& point_m) { return point_m.allFinite() && point_m.cwiseAbs().maxCoeff() <= kMaxStoredDistance_m; }

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

template <class Bytes, class Saved>
void link_fields(Bytes& bytes, Saved& link) {
  bytes.number(link.from);
  bytes.number(link.to);
  rigid3_fields(bytes, link.from_from_to);
  bytes.number(link.length_m);
  bytes.flag(link.is_loop);
  bytes.require(link.length_m >= 0 && std::isfinite(link.length_m), "the length of a link is out of range");
}

// adjust() validates the problem itself.
template <class Bytes, class Saved>
void problem_fields(Bytes& bytes, Saved& problem) {
  bytes.list(problem.world_from_submap, [](auto& to, auto& pose) { rigid3_fields(to, pose); });
  bytes.flags(problem.is_fixed);
  bytes.list(problem.keyframes, [](auto& to, auto& keyframe) {
    to.number(keyframe.submap);
    rigid3_fields(to, keyframe.submap_from_camera);
    to.number(keyframe.weight);
  });
  bytes.list(problem.landmarks_in_world, [](auto& to, auto& point) { to.numbers(point.data(), 3); });
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
void scope_fields(Bytes& bytes, Saved& scope) {
  bytes.numbers(scope.submaps);
  bytes.numbers(scope.landmarks);
  bytes.numbers(scope.sightings);
}

bool all_below(const std::vector<std::uint32_t>& indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(), [count](std::uint32_t index) { return index < count; });
}

// Sets the landmark of each feature from the observations; a feature may occur only once.
void assign_landmarks(ByteReader& bytes, SparseMap& map) {
  for (Keyframe& keyframe : map.keyframes) keyframe.landmark_of_feature.assign(keyframe.features.size(), kNoLandmark);
  for (std::size_t landmark = 0; landmark < map.landmarks.size(); ++landmark) {
    std::int64_t last_keyframe = -1;
    for (const Observation& observation : map.landmarks[landmark].observations) {
      const bool is_there = observation.keyframe < map.keyframes.size() && observation.keyframe > last_keyframe &&
                            observation.feature < map.keyframes[observation.keyframe].features.size() &&
                            map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] == kNoLandmark;
      bytes.require(is_there, "an observation of a landmark is invalid");
      if (!bytes.ok()) return;
      map.keyframes[observation.keyframe].landmark_of_feature[observation.feature] = static_cast<std::int32_t>(landmark);
      last_keyframe = observation.keyframe;
    }
  }
}

void check_map(ByteReader& bytes, const SparseMap& map) {
  const std::size_t submaps = map.world_from_submap.size();
  bytes.require(submaps >= 1 && submaps <= kMaxSubmaps, "the number of submaps is out of range");
  const std::size_t planes = depth_grid_of(map.camera).count();
  for (const Keyframe& keyframe : map.keyframes) {
    bytes.require(keyframe.submap < submaps && keyframe.features.size() <= static_cast<std::size_t>(kMaxFeatureCount),
                  "a keyframe has an invalid submap or too many features");
    bytes.require(keyframe.planes.empty() || keyframe.planes.size() == planes, "a keyframe has a wrong number of depth planes");
  }
  for (const Landmark& landmark : map.landmarks) bytes.require(landmark.submap < submaps, "the submap of a landmark is out of range");
}

void check_graph(ByteReader& bytes, const SubmapGraph& graph, std::size_t submaps, std::uint32_t component_count) {
  bytes.require(graph.component.size() == submaps && graph.parent.size() == submaps && component_count <= submaps,
                "the graph of submaps has a wrong size");
  bytes.require(all_below(graph.component, component_count) && all_below(graph.parent, submaps),
                "an entry of the submap graph is out of range");
  for (const SubmapLink& link : graph.links) bytes.require(link.from < submaps && link.to < submaps, "the ends of a link are out of range");
}

}  // namespace

template <class Bytes, class Saved>
void SubmapMapping::fields(Bytes& bytes, Saved& saved) {
  bytes.list(saved.map_.keyframes, [](auto& to, auto& keyframe) { keyframe_fields(to, keyframe); });
  bytes.list(saved.map_.landmarks, [](auto& to, auto& landmark) { landmark_fields(to, landmark); });
  bytes.list(saved.map_.world_from_submap, [](auto& to, auto& pose) { rigid3_fields(to, pose); });
  bytes.numbers(saved.graph_.component);
  bytes.numbers(saved.graph_.parent);
  bytes.list(saved.graph_.links, [](auto& to, auto& link) { link_fields(to, link); });
  bytes.flags(saved.layout_.is_active);
  bytes.number(saved.layout_.current);
  bytes.number(saved.layout_.correction_count);
  bytes.number(saved.layout_.closure_count);
  rigid3_fields(bytes, saved.submap_from_camera_);
  bytes.number(saved.frame_);
  bytes.number(saved.component_count_);
  bytes.number(saved.offered_at_keyframe_);
  bytes.require(is_index(saved.frame_) && is_index(saved.offered_at_keyframe_), "a frame index is out of range");
  for (auto& keyframe : saved.map_.keyframes)
    bytes.numbers(keyframe.planes);  // the largest share of the bytes; any value is valid, so they come last
}

template <class Bytes, class Saved>
void SubmapMapping::pending_fields(Bytes& bytes, Saved& pending) {
  link_fields(bytes, pending.link);
  bytes.number(pending.overlap);
  bytes.number(pending.frame);
  bytes.number(pending.keyframe);
  bytes.flag(pending.by_appearance);
  bytes.number(pending.later_verifications);
  bytes.require(pending.overlap >= 0 && pending.overlap <= 1 && is_index(pending.frame) && is_index(pending.keyframe),
                "the pending loop is invalid");
}

template <class Bytes, class Saved>
void SubmapMapping::running_fields(Bytes& bytes, Saved& running) {
  scope_fields(bytes, running.bundle.scope);
  problem_fields(bytes, running.bundle.problem);
  bytes.number(running.submap_count);
  bytes.number(running.due_frame);
  bytes.flag(running.is_global);
  bool is_bent = running.loop_since.has_value();
  bytes.flag(is_bent);
  std::uint32_t loop_since = running.loop_since.value_or(0);
  if (is_bent) bytes.number(loop_since);
  if constexpr (!std::is_const_v<Saved>) running.loop_since = is_bent ? std::optional(loop_since) : std::nullopt;
}

void SubmapMapping::save(ByteWriter& bytes) const {
  bytes.flag(time_ == CorrectionTime::kByFrames);
  fields(bytes, *this);
  index_.save(bytes);
  for (const MappingCountName& named : kMappingCountNames) bytes.number(counts_.*named.count);
  bytes.flag(pending_.has_value());
  if (pending_) pending_fields(bytes, *pending_);
  bytes.flag(running_.has_value());
  if (running_) running_fields(bytes, *running_);
}

void SubmapMapping::restore(ByteReader& bytes) {
  bool by_frames = false;
  bytes.flag(by_frames);
  bytes.require(by_frames == (time_ == CorrectionTime::kByFrames), "the state was saved in another mode, live or batch");
  fields(bytes, *this);
  const std::size_t submaps = map_.world_from_submap.size();
  check_map(bytes, map_);
  check_graph(bytes, graph_, submaps, component_count_);
  bytes.require(layout_.is_active.size() == submaps && layout_.current < submaps, "the current submap is out of range");
  if (bytes.ok()) assign_landmarks(bytes, map_);
  index_.restore(bytes, map_.landmarks.size());
  for (const MappingCountName& named : kMappingCountNames) bytes.number(counts_.*named.count);
  bool is_pending = false, is_running = false;
  bytes.flag(is_pending);
  if (is_pending) {
    PendingLoop pending;
    pending_fields(bytes, pending);
    bytes.require(pending.link.from < submaps && pending.link.to < submaps, "the ends of the pending loop are out of range");
    pending_ = pending;
  }
  bytes.flag(is_running);
  if (bytes.ok()) publish();
  if (is_running) restore_running(bytes);
}

void SubmapMapping::restore_running(ByteReader& bytes) {
  Running running;
  running_fields(bytes, running);
  const BundleScope& scope = running.bundle.scope;
  const BundleProblem& problem = running.bundle.problem;
  const std::size_t submaps = map_.world_from_submap.size(), landmarks = map_.landmarks.size();
  bytes.require(scope.submaps.size() == problem.world_from_submap.size() && scope.landmarks.size() == problem.landmarks_in_world.size() &&
                    scope.sightings.size() == problem.observations.size(),
                "a running adjustment does not fit the map");
  bytes.require(all_below(scope.submaps, submaps) && all_below(scope.landmarks, landmarks) && running.submap_count <= submaps &&
                    std::all_of(scope.sightings.begin(), scope.sightings.end(),
                                [landmarks](const BundleScope::Sighting& sighting) { return sighting.landmark < landmarks; }),
                "the scope of a running adjustment is out of range");
  bytes.require(!running.loop_since || *running.loop_since < submaps, "the submap of a closed loop is out of range");
  bytes.require(is_index(running.due_frame), "the frame at which an adjustment is due is out of range");
  if (!bytes.ok()) return;
  running.bundle.problem.camera = map_.camera;
  start(std::move(running));
}

}  // namespace hermite
