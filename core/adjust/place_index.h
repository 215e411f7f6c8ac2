// Place recognition: which places of the map an image may show, by its descriptors alone. There is
// no trained vocabulary.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/adjust/projection_match.h"
#include "core/adjust/sparse_map.h"
#include "core/base/byte_stream.h"

namespace hermite::adjust {

struct PlaceCandidate {
  std::uint32_t keyframe = 0;  // has the most votes among its neighbours
  // The place: the keyframe and those covisible with it, at most 10.
  std::vector<std::uint32_t> keyframes;
  double score = 0;  // votes of the keyframe; only their order is meaningful
  // Matches with landmarks of the place, one to one, in ascending order of features.
  std::vector<LandmarkMatch> matches;
};

// Multi-index hashing (Norouzi et al. 2012): a descriptor is in 16 tables, one for each of its
// 16-bit substrings. Descriptors that differ in d bits share a substring with a probability of
// about 1 - (1 - (1 - d/256)^16)^16: 0.9 at 30 bits, 0.67 at 40, 0.4 at 50; and a place has
// hundreds of them. A substring that kBucketSize landmarks have takes no more, because it is not
// distinctive.
//
// Memory: 16 tables of 65,536 heads (4 B) and counts (1 B), together 5 MiB, and 104 B per landmark.
// A query of 1000 features takes 20 ms at 100,000 landmarks and 120 ms at a million. Const
// functions are thread-safe.
class PlaceIndex {
 public:
  static constexpr std::uint8_t kBucketSize = 64;

  PlaceIndex();

  // Adds a landmark. Landmarks seen once are mostly never seen again, so add those that a second
  // keyframe has seen (InsertResult::repeated). A landmark may be added again with another
  // descriptor, for instance when its appearance has changed. Landmarks without observations
  // (tombstones, sparse_map.h) may stay.
  void add(std::uint32_t landmark, const Descriptor& descriptor);

  // Saves the added entries in order; the tables follow from them. restore() needs an empty index
  // and a map with `landmark_count` landmarks.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, std::size_t landmark_count);

  std::size_t size() const { return entries_.size(); }
  std::size_t memory_bytes() const;

  // Returns at most kMaxCandidates places, best first; no two of them share kLeastShared landmarks.
  // A feature votes for the keyframes that see a landmark within kMaxPlaceDistance bits, with a
  // weight of 1 over the number of such landmarks, because frequent ones are not distinctive.
  // `excluded` keyframes get no votes and are in no place. All landmarks of the index must be in
  // `map`.
  std::vector<PlaceCandidate> query(const std::vector<Feature>& features, const SparseMap& map,
                                    const std::vector<std::uint32_t>& excluded = {}) const;

  // Returns all landmarks within kMaxPlaceDistance bits of each feature that is not too frequent;
  // ascending features.
  std::vector<LandmarkMatch> similar(const std::vector<Feature>& features,
                                     const SparseMap& map) const;

 private:
  static constexpr std::size_t kTables = 16;
  static constexpr std::size_t kBuckets = 1 << 16;

  struct Entry {
    Descriptor descriptor;
    std::uint32_t landmark;
    std::array<std::uint32_t, kTables> next;  // entry in the same bucket, by table
  };
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> heads_;  // by table and substring: the entry added last
  std::vector<std::uint8_t> counts_;
};

}  // namespace hermite::adjust
