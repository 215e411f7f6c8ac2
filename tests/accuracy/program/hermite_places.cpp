// hermite_places: how many revisits are seen, and how many are made up, in synthetic worlds built
// to be mistaken. Two laps through each; prints one row of a Markdown table a world.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "core/pipeline/pipeline.h"
#include "core/source/open_sequence.h"
#include "core/synthetic/world_paths.h"
#include "tests/accuracy/program/guarded_main.h"
#include "tests/accuracy/program/place_audit.h"

namespace hermite {

namespace {

struct World {
  const char* name;
  synthetic::RoomScene scene;
};
constexpr World kWorlds[] = {{"loop", synthetic::RoomScene::kLoop},
                             {"twins", synthetic::RoomScene::kTwins},
                             {"office", synthetic::RoomScene::kOffice},
                             {"blank", synthetic::RoomScene::kBlank}};

struct Walk {
  double rate_hz = 10;  // hasty: 4 cm a frame
  int seed = 1;
  std::string device;
};

const World& world_of(const std::string& name) {
  for (const World& world : kWorlds)
    if (name == world.name) return world;
  throw SetupError(
      {ErrorCode::kInvalidArgument, "no world " + name + "; there are loop, twins, office, blank"});
}

PlaceCounts audit(const World& world, const Walk& walk, PlaceQuestion question) {
  const auto lap_frames =
      static_cast<std::int64_t>(std::ceil(synthetic::world_lap_s(world.scene) * walk.rate_hz));
  const auto sequence = or_throw(source::open_sequence(
      "synthetic:scene=" + std::string(world.name) + ",frames=" + std::to_string(2 * lap_frames) +
      ",width=320,height=240,noise=kinect-white,rate=" + std::to_string(walk.rate_hz) +
      ",seed=" + std::to_string(walk.seed)));
  const pipeline::Options options;
  auto mapping = std::make_unique<PlaceAudit>(
      adjust::make_mapping(sequence->camera(), options.adjust, adjust::CorrectionTime::kByFrames),
      sequence->groundtruth(), question, lap_frames);
  PlaceAudit& audit = *mapping;
  pipeline::Pipeline pipeline(walk.device, sequence->camera(), options, std::move(mapping));
  for (std::int64_t i = 0; i < sequence->frame_count(); ++i)
    or_throw(pipeline.process(or_throw(dataset::decode_frame(or_throw(sequence->read(i))))));
  return audit.result();
}

void print_row(const World& world, const char* question, const PlaceCounts& counts) {
  const auto percent = [](std::int64_t part, std::int64_t of) {
    return of == 0 ? 100.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of);
  };
  std::printf("| %s | %s | %lld | %lld | %lld | %lld | %.0f | %.0f |\n", world.name, question,
              static_cast<long long>(counts.known), static_cast<long long>(counts.unguessed),
              static_cast<long long>(counts.right), static_cast<long long>(counts.wrong),
              percent(counts.right, counts.known),
              percent(counts.right, counts.right + counts.wrong));
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"Revisits seen and made up in synthetic worlds"};
  std::vector<std::string> worlds{"twins", "office", "blank"};
  Walk walk;
  app.add_option("world", worlds, "loop, twins, office, blank")->capture_default_str();
  app.add_option("--rate", walk.rate_hz, "Frames a second of a camera that walks at 0.4 m/s")
      ->check(CLI::Range(1.0, 60.0))
      ->capture_default_str();
  app.add_option("--seed", walk.seed, "Of the noise")->capture_default_str();
  app.add_option("--device", walk.device, "GPU: an index or a part of its name");
  CLI11_PARSE(app, argc, argv);
  std::printf(
      "| world | question | known ground | nothing guessed | right | wrong | recall %% | precision "
      "%% "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : worlds) {
    print_row(world_of(name), "back again?", audit(world_of(name), walk, PlaceQuestion::kLoop));
    print_row(world_of(name), "lost", audit(world_of(name), walk, PlaceQuestion::kLost));
  }
  return 0;
}

}  // namespace

}  // namespace hermite

int main(int argc, char** argv) {
  return hermite::guarded_main("hermite_places", [&] { return hermite::run(argc, argv); });
}
