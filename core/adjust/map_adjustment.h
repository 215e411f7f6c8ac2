// Adjusts the submaps beside the frames: takes a problem from the atlas, has it solved on a helper
// thread, and applies the solution when it is due, with what has changed in the meantime.
// One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/adjust/adjuster.h"
#include "core/adjust/bundle_of_map.h"
#include "core/adjust/mapping_counts.h"
#include "core/adjust/submap_atlas.h"
#include "core/base/byte_stream.h"

namespace hermite::adjust {

// All calls take the same atlas.
class MapAdjustment {
 public:
  explicit MapAdjustment(CorrectionTime time);

  // Starts to adjust the submaps around the camera by their landmarks, unless an adjustment runs.
  void start_local(const SubmapAtlas& atlas);

  // Call it when a loop has closed: starts to adjust all submaps of the camera's component.
  void start_global(const SubmapAtlas& atlas);

  // Applies the running adjustment's result if it is due, and starts the next one if a loop has
  // closed in the meantime. In batch mode it is due a number of frames after the start that
  // depends on the problem alone, and waited for; live, it is due as soon as it is there.
  void apply_due(SubmapAtlas& atlas, MappingCounts& counts);

  // Call it after the last frame. Waits for the running adjustment and, if a loop was ever closed,
  // adjusts the camera's component once more; `by_depth`, also by its keyframes' depth.
  void finish(SubmapAtlas& atlas, bool by_depth, MappingCounts& counts);

  // Does not wait: the problem is saved, and restore() starts it again. It needs an object that has
  // started nothing, and the restored atlas.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, const SubmapAtlas& atlas);

 private:
  struct Running {
    BundleOfMap bundle;
    std::uint64_t submap_count = 0;  // number of submaps when it began
    std::int64_t due_frame = 0;
    bool is_global = false;
    // The current submap when the last loop closed since this adjustment began. The map has been
    // bent meanwhile and must be adjusted again afterwards.
    std::optional<std::uint32_t> loop_since;
  };

  template <class Bytes, class Saved>
  static void running_fields(Bytes& bytes, Saved& running);
  static Running global_adjustment(const SubmapAtlas& atlas, std::uint32_t component);
  void give_up();
  void start(Running running);
  void apply_result(const Result<BundleSolution>& result, SubmapAtlas& atlas,
                    MappingCounts& counts);

  const CorrectionTime time_;
  std::unique_ptr<Adjuster> adjuster_;
  std::optional<Running> running_;
};

}  // namespace hermite::adjust
