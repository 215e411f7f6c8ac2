// The implementation of Mapping: submaps that are opened as the camera moves (SubmapAtlas),
// keyframes with ORB landmarks, loop candidates by nearness and by appearance (PlaceSearch), loops
// that are closed once well seen (LoopDecision), and bundle adjustment in the background
// (MapAdjustment). Only for core/adjust and its tests; others call make_mapping().
#pragma once

#include "core/adjust/loop_decision.h"
#include "core/adjust/map_adjustment.h"
#include "core/adjust/mapping.h"
#include "core/adjust/place_search.h"
#include "core/adjust/submap_atlas.h"

namespace hermite::adjust {

class SubmapMapping final : public Mapping {
 public:
  SubmapMapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time);

  const MapLayout& layout() const override { return atlas_.layout; }
  std::vector<LoopCandidate> observe(const frame::RgbdFrame& frame,
                                     const Rigid3& world_from_camera) override;
  bool confirm(const LoopCandidate& candidate, const LoopVerification& verified) override;
  std::vector<LoopCandidate> relocalise(const frame::RgbdFrame& frame) override;
  bool is_distinctive(const frame::RgbdFrame& frame, const Rigid3& world_from_camera,
                      std::int64_t known_keyframes) const override;
  void relocalised(const LoopCandidate& candidate, const Rigid3& world_from_camera) override;
  void begin_component(const Rigid3& world_from_camera, double reach_m) override;
  void finish() override;
  MappingCounts counts() const override;
  void save(ByteWriter& bytes) const override;
  void restore(ByteReader& bytes) override;

 private:
  std::vector<LoopCandidate> take_keyframe(const frame::RgbdFrame& frame);
  bool close(const VerifiedLoop& loop);

  const AdjustOptions options_;
  const CorrectionTime time_;
  SubmapAtlas atlas_;
  PlaceSearch places_;
  LoopDecision loops_;
  MapAdjustment adjustment_;
  MappingCounts counts_;
};

}  // namespace hermite::adjust
