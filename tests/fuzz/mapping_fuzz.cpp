// The state of a scan's back end, as a checkpoint has it. Input: a byte for when corrections come
// and whether the scan is gone on with, which takes most of the time; data.
//
// There is no checksum in it: what is read is one, and the scan has to live on with it.
#include "tests/fuzz/mapping_walk.h"

namespace {

using namespace hermite;

std::string saved(const adjust::Mapping& mapping) {
  ByteWriter bytes;
  mapping.save(bytes);
  return bytes.take();
}

// Tracked, lost and found again, as far as the state allows.
void go_on(adjust::Mapping& mapping) {
  const std::size_t submaps = mapping.layout().world_from_submap.size();
  CHECK(mapping.layout().current < submaps && mapping.layout().component.size() == submaps &&
            mapping.layout().is_active.size() == submaps,
        "a layout of nothing");
  for (const std::size_t i : {fuzz::kSeenFrames, std::size_t{0}})
    for (const adjust::LoopCandidate& candidate :
         mapping.observe(fuzz::frame_at(i), fuzz::world_from_camera(i)))
      mapping.confirm(candidate, {candidate.world_from_camera, i == 0 ? 1.0 : 0.3});
  const std::vector<adjust::LoopCandidate> candidates = mapping.relocalise(fuzz::frame_at(1));
  if (candidates.empty())
    mapping.begin_component(Rigid3{}, 1);
  else
    mapping.relocalised(candidates.front(), candidates.front().world_from_camera);
  mapping.finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto time =
      data[0] % 2 == 0 ? adjust::CorrectionTime::kByFrames : adjust::CorrectionTime::kWhenReady;
  const std::unique_ptr<adjust::Mapping> mapping = fuzz::make_walker(time);
  ByteReader bytes({reinterpret_cast<const char*>(data) + 1, size - 1});
  mapping->restore(bytes);
  if (!bytes.ok()) {
    CHECK(!bytes.status().error().message.empty(), "an error without words");
    return 0;
  }
  const std::unique_ptr<adjust::Mapping> another = fuzz::make_walker(time);
  const std::string state = saved(*mapping);
  ByteReader again(state);
  another->restore(again);
  CHECK(again.ok() && again.at_end() && saved(*another) == state, "a state does not round-trip");
  if (data[0] / 2 % 4 == 0) go_on(*mapping);
  return 0;
}
