// The cloud of a running scan as its viewers get it: chunks that have changed are encoded anew on a thread beside the scan's own.
//
// Owned by the scan's worker; one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <set>
#include <vector>

#include "core/output/chunks.h"
#include "server/scan/scan_worker.h"

namespace hermite {

class ChunkEncoder {
 public:
  // Points of less confidence are not shown.
  explicit ChunkEncoder(double least_confidence) : model_(0, least_confidence) {}

  // CHECK: the update before was taken.
  void start(std::vector<SlotChange> changes);

  bool is_busy() const { return encoding_.valid(); }
  bool is_done() const;  // take() does not wait

  // Waits for what was started: chunks alone, and how long they took. CHECK: is_busy(). kTooLarge, kCorruptData: as chunks.h.
  Result<ModelUpdate> take();

  // All that there are now. CHECK: not is_busy().
  Result<std::vector<EncodedChunk>> all();

 private:
  Result<ModelUpdate> encode(const std::vector<SlotChange>& changes);

  ChunkedModel model_;
  std::set<ChunkKey> filled_;                  // chunks that have points
  std::uint64_t version_ = 0;                  // of the chunks, one count for all
  std::future<Result<ModelUpdate>> encoding_;  // last: its destructor waits for what uses the others
};

}  // namespace hermite
