// The implementation of Mapping: submaps that are opened as the camera moves, keyframes with ORB
// landmarks, loop candidates by nearness and by appearance, and bundle adjustment in the
// background. Only for core/adjust and its tests; others call make_mapping().
#pragma once

#include <memory>
#include <optional>

#include "core/adjust/adjuster.h"
#include "core/adjust/bundle_of_map.h"
#include "core/adjust/mapping.h"
#include "core/adjust/place_index.h"
#include "core/adjust/recognise.h"
#include "core/adjust/sparse_map.h"
#include "core/adjust/submap_graph.h"

namespace hermite {

class SubmapMapping final : public Mapping {
 public:
  SubmapMapping(const Camera& camera, const AdjustOptions& options, CorrectionTime time);

  const MapLayout& layout() const override { return layout_; }
  std::vector<LoopCandidate> observe(const RgbdFrame& frame, const Rigid3& world_from_camera) override;
  bool confirm(const LoopCandidate& candidate, const LoopVerification& verified) override;
  std::vector<LoopCandidate> relocalise(const RgbdFrame& frame) override;
  bool is_distinctive(const RgbdFrame& frame, const Rigid3& world_from_camera, std::int64_t known_keyframes) const override;
  void relocalised(const LoopCandidate& candidate, const Rigid3& world_from_camera) override;
  void begin_component(const Rigid3& world_from_camera) override;
  void finish() override;
  MappingCounts counts() const override;
  void save(ByteWriter& bytes) const override;
  void restore(ByteReader& bytes) override;

 private:
  struct Running {
    BundleOfMap bundle;              // the adjuster's problem; restore() starts it again
    std::uint64_t submap_count = 0;  // number of submaps when it began
    std::int64_t due_frame = 0;
    bool is_global = false;
    // The current submap when the last loop closed since this adjustment began. The map has been
    // bent meanwhile and must be adjusted again afterwards.
    std::optional<std::uint32_t> loop_since;
  };

  // A loop that is verified again as long as the camera sees more of the place.
  struct PendingLoop {
    SubmapLink link;  // by the verification with the largest overlap
    double overlap = 0;
    std::int64_t frame = 0, keyframe = 0;  // of that verification: the frame, and the number of keyframes then
    bool by_appearance = false;
    std::uint32_t later_verifications = 0;  // later successful verifications
  };

  Rigid3 world_from_camera() const { return map_.world_from_submap[layout_.current] * submap_from_camera_; }
  bool is_active(std::uint32_t submap) const { return layout_.is_active[submap]; }
  std::uint32_t open_submap(const Rigid3& world_from_submap, std::uint32_t component);
  void choose_submap();
  void go_on_in(std::uint32_t submap, const Rigid3& world_from_camera);
  void update_active();
  std::vector<std::uint32_t> submaps_of(std::uint32_t component) const;
  std::vector<std::uint32_t> keyframes_in_view(bool active) const;
  bool is_new_view() const;
  std::vector<std::uint32_t> keyframes_near(double distance_m, double turn_rad, bool active) const;
  std::vector<LoopCandidate> take_keyframe(const RgbdFrame& frame);
  void adjust_locally();
  void adjust_globally();
  Running global_adjustment(std::uint32_t component) const;
  void give_up();
  void straighten(const std::vector<std::uint32_t>& submaps);
  void start(Running running);
  void apply_due();
  void apply_result(const Result<BundleSolution>& result);
  void publish();
  void publish_correction();
  // Defined in submap_mapping_loops.cpp.
  std::vector<LoopCandidate> recognised(const std::vector<Feature>& features);
  std::vector<LoopCandidate> near_inactive();
  std::vector<bool> submaps_in_view(const Rigid3& world_from_camera, std::uint32_t component) const;
  LoopCandidate candidate_at(const Rigid3& world_from_camera, std::uint32_t submap, bool by_appearance) const;
  std::uint32_t nearest_submap(const std::vector<bool>& among, const Rigid3& world_from_camera) const;
  bool is_of_another_component(const LoopCandidate& candidate) const;
  std::vector<LoopCandidate> pending_candidate() const;
  bool bend(const SubmapLink& loop);
  void join(const SubmapLink& loop);
  bool close(const PendingLoop& loop);
  void close_when_seen();
  // Defined in submap_mapping_state.cpp.
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved);
  template <class Bytes, class Saved>
  static void pending_fields(Bytes& bytes, Saved& pending);
  template <class Bytes, class Saved>
  static void running_fields(Bytes& bytes, Saved& running);
  void restore_running(ByteReader& bytes);

  const AdjustOptions options_;
  const CorrectionTime time_;
  SparseMap map_;
  SubmapGraph graph_;
  PlaceIndex index_;
  MapLayout layout_;
  Rigid3 submap_from_camera_;  // pose of the last observed frame in the current submap
  std::int64_t frame_ = -1;    // index of the last observed frame
  std::uint32_t component_count_ = 1;
  std::int64_t offered_at_keyframe_ = -1000;  // number of keyframes when near submaps were last candidates
  std::unique_ptr<Adjuster> adjuster_;
  std::optional<Running> running_;
  std::optional<PendingLoop> pending_;
  MappingCounts counts_;
};

}  // namespace hermite
