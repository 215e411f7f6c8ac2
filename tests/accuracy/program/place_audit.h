// A back end that is asked where the camera is and never believed: the front end looks at every
// guess as in a scan, the audit compares what fits with the true pose, and then refuses. So the
// camera is at known ground for as long as the walk goes on, and each keyframe of a second lap is
// one candidate. What is mapped in the second lap lies where the camera has drifted to, and is not
// shown.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/dataset/trajectory.h"

namespace hermite {

enum class PlaceQuestion {
  kLoop,  // a tracked camera at each keyframe: has it come back to inactive submaps?
  kLost,  // a camera that knows nothing, every few frames, in the map of the first lap
};

// Guesses of one frame that fitted densely.
struct PlaceCounts {
  // Questions asked where the map knows the ground and does not track against it.
  std::int64_t known = 0;
  std::int64_t right = 0;      // of these, answered within the bounds below
  std::int64_t wrong = 0;      // answers beyond them, wherever they were asked
  std::int64_t unguessed = 0;  // known ground, and nothing to look at
};

// Distance from the nearest view that the map has of the place, so that what the map has drifted by
// does not count. Half a step to the side is a wrong place.
inline constexpr double kRight_m = 0.05, kRight_deg = 2.0;

class PlaceAudit final : public adjust::Mapping {
 public:
  // `truth`: world_from_camera of every frame. With kLost the map is that of the first `lap_frames`
  // frames.
  PlaceAudit(std::unique_ptr<adjust::Mapping> mapping, const dataset::Trajectory& truth,
             PlaceQuestion question, std::int64_t lap_frames);

  // Closes the question asked last.
  const PlaceCounts& result();

  const adjust::MapLayout& layout() const override { return mapping_->layout(); }
  std::vector<adjust::LoopCandidate> observe(const frame::RgbdFrame& frame,
                                             const Rigid3& world_from_camera) override;
  bool confirm(const adjust::LoopCandidate& candidate,
               const adjust::LoopVerification& verified) override;
  std::vector<adjust::LoopCandidate> relocalise(const frame::RgbdFrame&) override { return {}; }
  bool is_distinctive(const frame::RgbdFrame&, const Rigid3&, std::int64_t) const override {
    return true;
  }
  void relocalised(const adjust::LoopCandidate&, const Rigid3&) override {}
  void begin_component(const Rigid3& world_from_camera, double reach_m) override {
    mapping_->begin_component(world_from_camera, reach_m);
  }
  void finish() override { result(); }
  adjust::MappingCounts counts() const override { return mapping_->counts(); }
  void save(ByteWriter& bytes) const override { mapping_->save(bytes); }
  void restore(ByteReader& bytes) override { mapping_->restore(bytes); }

 private:
  struct View {
    Rigid3 true_pose, mapped_pose;
    std::uint32_t submap = 0;
  };

  std::vector<adjust::LoopCandidate> ask_about_loop(const frame::RgbdFrame& frame,
                                                    const Rigid3& world_from_camera);
  std::vector<adjust::LoopCandidate> ask_lost(const frame::RgbdFrame& frame);
  void show_first_lap_only(std::vector<adjust::LoopCandidate>& candidates) const;
  bool knows(const Rigid3& true_pose) const;
  bool is_right(const adjust::LoopCandidate& candidate, const Rigid3& seen_from) const;

  const std::unique_ptr<adjust::Mapping> mapping_;
  const dataset::Trajectory truth_;
  const PlaceQuestion question_;
  const std::int64_t lap_frames_;
  std::size_t lap_submaps_ = 0;  // that were opened in the first lap
  std::int64_t frame_ = -1;
  Rigid3 true_pose_;
  std::vector<View> views_;  // of keyframes
  bool asked_at_known_ = false, answered_right_ = false;
  PlaceCounts counts_;
};

}  // namespace hermite
