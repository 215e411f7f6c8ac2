// Encodes the cloud of a running scan for its viewers: changed chunks are encoded on a thread
// beside the scan's own.
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

namespace hermite::server {

class ChunkEncoder {
 public:
  // Points with less confidence are not shown.
  explicit ChunkEncoder(double least_confidence) : model_(0, least_confidence) {}

  // CHECK: the previous update was taken.
  void start(std::vector<output::SlotChange> changes);

  bool is_busy() const { return encoding_.valid(); }
  bool is_done() const;  // take() would not block

  // Waits for the started encoding; returns only chunks and the time they took. CHECK: is_busy().
  // Errors as of chunks.h.
  Result<ModelUpdate> take();

  // All present chunks. CHECK: not is_busy().
  Result<std::vector<output::EncodedChunk>> all();

 private:
  Result<ModelUpdate> encode(const std::vector<output::SlotChange>& changes);

  output::ChunkedModel model_;
  std::set<output::ChunkKey> filled_;  // keys of chunks with points
  std::uint64_t version_ = 0;          // of chunks, one counter for all
  // Last member: its destructor waits for the task, which uses the others.
  std::future<Result<ModelUpdate>> encoding_;
};

}  // namespace hermite::server
