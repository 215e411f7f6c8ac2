// Decides when a verified loop is closed: at once where much of the place was in view, and
// otherwise with the best of its verifications, as soon as the camera sees no more of it.
// One thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/adjust/mapping_counts.h"
#include "core/adjust/submap_atlas.h"
#include "core/base/byte_stream.h"

namespace hermite::adjust {

struct VerifiedLoop {
  SubmapLink link;  // by the verification with the largest overlap
  double overlap = 0;
  // The frame of that verification, and the number of keyframes then.
  std::int64_t frame = 0, keyframe = 0;
  bool by_appearance = false;
  std::uint32_t later_verifications = 0;  // later successful verifications
};

class LoopDecision {
 public:
  // What follows from a verification.
  struct Verdict {
    bool is_possible = false;  // not beyond the drift that tracking can have
    // The loop to be closed now; if there is none, a possible loop is pending.
    std::optional<VerifiedLoop> close;
  };
  // Takes a verification of a candidate by the last observed frame.
  Verdict verified(const SubmapAtlas& atlas, const LoopCandidate& candidate,
                   const LoopVerification& verification);

  // A loop that is verified again as long as the camera sees more of the place.
  bool is_pending() const { return pending_.has_value(); }

  // Returns the place of the pending loop as a candidate, at the camera's pose if the loop is
  // right; none when the camera is in another component.
  std::vector<LoopCandidate> pending_candidate(const SubmapAtlas& atlas) const;

  // Returns the pending loop, which is then no longer pending, when the camera sees no more of the
  // place. Drops and counts it instead if no later verification succeeded.
  std::optional<VerifiedLoop> take_due(const SubmapAtlas& atlas, MappingCounts& counts);

  // Returns the pending loop, if any, which is then no longer pending.
  std::optional<VerifiedLoop> take();

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, std::size_t submap_count);

 private:
  std::optional<VerifiedLoop> pending_;
};

}  // namespace hermite::adjust
