// Which places of the map an image could show, found by its descriptors alone. No vocabulary is learnt or loaded.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/adjust/projection_match.h"
#include "core/adjust/sparse_map.h"
#include "core/base/byte_stream.h"

namespace hermite {

struct PlaceCandidate {
  std::uint32_t keyframe = 0;            // with the most votes among its neighbours
  std::vector<std::uint32_t> keyframes;  // it and those that share most with it, 10 at most: the place
  double score = 0;                      // the keyframe's votes; only their order means something
  std::vector<LandmarkMatch> matches;    // with landmarks of the place, one to one, ascending features
};

// Multi-index hashing (Norouzi et al. 2012): a descriptor is in 16 tables, by each of its 16-bit pieces. Descriptors that differ in d bits
// share a piece with a chance of about 1 - (1 - (1 - d/256)^16)^16: 0.9 at 30 bits, 0.67 at 40, 0.4 at 50; a place has hundreds.
// A value of a piece that kBucketSize landmarks have takes no more: it says little about the place.
//
// Memory: 16 tables of 65,536 heads (4 B) and counts (1 B), 5 MiB, and 104 B a landmark. A query of 1000 features takes 20 ms at 100,000
// landmarks, 120 ms at a million. Const functions are thread-safe.
class PlaceIndex {
 public:
  static constexpr std::uint8_t kBucketSize = 64;

  PlaceIndex();

  // Landmarks seen once are mostly never seen again: remember those that a second keyframe has seen (InsertResult::repeated).
  // A landmark may come again with another descriptor, for instance when its appearance changed. Tombstones need not be taken out.
  void add(std::uint32_t landmark, const Descriptor& descriptor);

  // What was added, in order: the rest follows from it. restore() is of an empty index, of a map that has so many landmarks.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, std::size_t landmark_count);

  std::size_t size() const { return entries_.size(); }
  std::size_t memory_bytes() const;

  // The best places, best first, kMaxCandidates at most; none shares kLeastShared landmarks with a better one. A feature votes for the
  // keyframes that see a landmark within kMaxPlaceDistance bits, with 1 over the number of such landmarks: what is everywhere says little.
  // `excluded` keyframes get no votes and are in no place. Every landmark of the index is one of `map`.
  std::vector<PlaceCandidate> query(const std::vector<Feature>& features, const SparseMap& map,
                                    const std::vector<std::uint32_t>& excluded = {}) const;

 private:
  static constexpr std::size_t kTables = 16;
  static constexpr std::size_t kBuckets = 1 << 16;

  struct Entry {
    Descriptor descriptor;
    std::uint32_t landmark;
    std::array<std::uint32_t, kTables> next;  // in the same bucket, by table
  };
  std::vector<LandmarkMatch> similar(const std::vector<Feature>& features, const SparseMap& map) const;

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> heads_;  // by table and piece: the entry added last
  std::vector<std::uint8_t> counts_;
};

}  // namespace hermite
