// Searches the map for places that the camera may have come back to: by their landmarks'
// appearance, and by nearness to the camera's pose. All of them are candidates until verified.
// One thread at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/mapping_counts.h"
#include "core/adjust/place_index.h"
#include "core/adjust/submap_atlas.h"
#include "core/base/byte_stream.h"

namespace hermite::adjust {

class PlaceSearch {
 public:
  // From now on these landmarks of the map are recognised.
  void add(const SparseMap& map, const std::vector<std::uint32_t>& landmarks);

  // Returns candidates in inactive submaps that look like the features, if the camera can have
  // drifted that far. Others are counted and left out.
  std::vector<LoopCandidate> recognised(const SubmapAtlas& atlas,
                                        const std::vector<Feature>& features,
                                        MappingCounts& counts) const;

  // Returns as a candidate the inactive submaps that the camera should see if it has not drifted;
  // none for some keyframes after it has returned one.
  std::vector<LoopCandidate> near(const SubmapAtlas& atlas);

  // Returns the place that the features of a lost camera show. If they show several, returns none
  // and counts it.
  std::vector<LoopCandidate> relocalise(const SubmapAtlas& atlas,
                                        const std::vector<Feature>& features,
                                        MappingCounts& counts) const;

  // See Mapping::is_distinctive().
  bool is_distinctive(const SparseMap& map, const std::vector<Feature>& features,
                      const Rigid3& world_from_camera, std::int64_t known_keyframes) const;

  // restore() needs an object to which nothing was added, and the number of landmarks of the map.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, std::size_t landmark_count);

 private:
  PlaceIndex index_;
  // Number of keyframes when near() last returned a candidate.
  std::int64_t offered_at_keyframe_ = -1000;
};

}  // namespace hermite::adjust
