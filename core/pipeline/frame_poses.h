// The poses of all frames so far, lost ones included: relative to their submaps, which does not
// change when submaps move, and in the world.
//
// One thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/byte_stream.h"
#include "core/dataset/trajectory.h"
#include "core/math/rigid3_fields.h"
#include "core/pipeline/frame_result.h"

namespace hermite::pipeline {

class FramePoses {
 public:
  // Adds the pose of the next frame, with the time and the status of its result. `reason`: number
  // of the reason in the ReasonTable. The pose is in the layout's current submap. Frames that were
  // lost just before get poses in between (lost_poses.h).
  void add(const FrameResult& result, std::uint16_t reason, const Rigid3& world_from_camera,
           const adjust::MapLayout& layout);

  // Moves the poses in the world with the submaps, if the layout was corrected since.
  void follow_corrections(const adjust::MapLayout& layout) {
    follow_corrections(layout, anchored_.size());
  }

  // Copies the last pose into the result of its frame, which is the last of `lost_count` lost ones.
  void describe_last(int lost_count, FrameResult& result) const;

  std::size_t size() const { return anchored_.size(); }
  const std::vector<AnchoredPose>& anchored() const { return anchored_; }
  // In the world, with the frames' own timestamps.
  const dataset::Trajectory& trajectory() const { return trajectory_; }

  // The state in a checkpoint, both ways. After reading, the reader fails in require_valid() unless
  // the numbers of submaps and reasons (reason_table.h) include those of all poses.
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved);
  void require_valid(ByteReader& bytes, std::size_t submap_count, std::size_t reason_count) const;

 private:
  void follow_corrections(const adjust::MapLayout& layout, std::size_t first);

  std::vector<AnchoredPose> anchored_;
  dataset::Trajectory trajectory_;  // of the same frames, at the layout of correction_count_
  std::uint64_t correction_count_ = 0;
};

template <class Bytes, class Saved>
void FramePoses::fields(Bytes& bytes, Saved& saved) {
  bytes.list(saved.anchored_, [](auto& to, auto& pose) {
    to.number(pose.timestamp_s);
    to.number(pose.submap);
    rigid3_fields(to, pose.submap_from_camera);
    to.number(pose.status);
    to.number(pose.reason);
  });
  bytes.list(saved.trajectory_, [](auto& to, auto& pose) {
    to.number(pose.timestamp_s);
    rigid3_fields(to, pose.world_from_camera);
  });
  bytes.number(saved.correction_count_);
}

}  // namespace hermite::pipeline
