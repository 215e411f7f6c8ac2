#include "core/image/zstd_bytes.h"
#include "server/scan/checkpoint_file.h"
#include "tests/fuzz/checkpoint_conditions.h"
#include "tests/fuzz/mapping_walk.h"
#include "tests/fuzz/seed_folder.h"

namespace hermite::fuzz {

namespace {

constexpr std::size_t kHeaderBytes = 12;  // of a checkpoint, before the zstd frame

std::string head_of(const pipeline::Conditions& conditions) {
  ByteWriter bytes;
  pipeline::write_head(bytes, conditions);
  return bytes.take();
}

}  // namespace

void add_checkpoint_seeds(SeedFolder seeds) {
  for (const bool tracked : {false, true}) {
    server::ScanCheckpoint checkpoint{"01arz3ndektsv4rrffq69g5fav", 17, std::nullopt,
                                      head_of(kConditions)};
    if (tracked) checkpoint.last_tracked = wire::TrackedFrame{12, 3.5};
    const std::string file = server::format_checkpoint(checkpoint),
                      frame = file.substr(kHeaderBytes);
    seeds.add(std::string(1, 0) + file);
    seeds.add(std::string(1, 1) + *image::decompress_bytes(frame, server::kMaxCheckpointBytes));
    seeds.add(std::string(1, 2) + frame);
  }
  seeds.add(std::string(1, 2) + image::compress_bytes(std::string(100'000'000, 0)));
  pipeline::Conditions others = kConditions;
  others.back().second = "11";
  for (const pipeline::Conditions& conditions : {kConditions, others, pipeline::Conditions{}})
    seeds.add(std::string(1, 3) + head_of(conditions));
}

// Saves after every second frame, so that an adjustment runs in some and not in others; each second
// one is gone on with.
void add_mapping_seeds(SeedFolder seeds) {
  for (const adjust::CorrectionTime time :
       {adjust::CorrectionTime::kByFrames, adjust::CorrectionTime::kWhenReady}) {
    const std::unique_ptr<adjust::Mapping> mapping = make_walker(time);
    for (std::size_t i = 0; i <= kSeenFrames; ++i) {
      if (i % 2 == 0) {
        ByteWriter bytes;
        mapping->save(bytes);
        seeds.add(
            std::string(1, static_cast<char>((time == adjust::CorrectionTime::kByFrames ? 0 : 1) +
                                             (i % 4 == 0 ? 2 : 0))) +
            bytes.take());
      }
      if (i < kSeenFrames) mapping->observe(frame_at(i), world_from_camera(i));
    }
  }
}

}  // namespace hermite::fuzz
