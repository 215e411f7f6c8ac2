#include "server/scan/chunk_encoder.h"

#include <memory>
#include <utility>

#include "core/base/check.h"
#include "core/base/step_back.h"
#include "proto/wire/server_message.h"

namespace hermite::server {

void ChunkEncoder::start(std::vector<output::SlotChange> changes) {
  CHECK(!is_busy(), "an update that nobody has taken");
  encoding_ = std::async(std::launch::async,
                         [this, changes = std::move(changes)] { return encode(changes); });
}

bool ChunkEncoder::is_done() const {
  return encoding_.valid() &&
         encoding_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

Result<ModelUpdate> ChunkEncoder::take() {
  CHECK(is_busy(), "no update was started");
  return encoding_.get();
}

Result<std::vector<output::EncodedChunk>> ChunkEncoder::all() {
  CHECK(!is_busy(), "an update that nobody has taken");
  std::vector<output::EncodedChunk> chunks;
  for (const output::ChunkKey& key : filled_) {
    Result<output::EncodedChunk> chunk = model_.encode(key);
    if (!chunk.ok()) return chunk.error();
    chunks.push_back(*std::move(chunk));
  }
  return chunks;
}

Result<ModelUpdate> ChunkEncoder::encode(const std::vector<output::SlotChange>& changes) {
  using Clock = std::chrono::steady_clock;
  step_back();
  ModelUpdate update;
  update.encoding = {"encode", Clock::now(), 0};
  model_.apply(changes);
  for (const output::ChunkKey& key : model_.take_dirty()) {
    Result<output::EncodedChunk> chunk = model_.encode(key);
    if (!chunk.ok()) return chunk.error();
    const bool empty = chunk->point_count == 0;
    if (empty) filled_.erase(key);
    if (!empty) filled_.insert(key);
    wire::Chunk message{{key.submap, key.level, key.x, key.y, key.z},
                        ++version_,
                        chunk->point_count,
                        std::move(chunk->draco)};
    update.chunks.push_back(
        {key, empty,
         std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
  }
  update.encoding.duration_ms =
      std::chrono::duration<double, std::milli>(Clock::now() - update.encoding.start).count();
  return update;
}

}  // namespace hermite::server
