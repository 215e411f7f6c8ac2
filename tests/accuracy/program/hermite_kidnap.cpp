// hermite_kidnap: a camera that sees nothing for a while, at random times of a walk through a
// synthetic world. How soon is it found after it sees known ground again, and what does it cost?
// Prints a Markdown table, one row a run.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <vector>

#include "core/evaluate/trajectory_error.h"
#include "core/pipeline/pipeline.h"
#include "core/source/open_sequence.h"
#include "tests/accuracy/program/guarded_main.h"

namespace hermite {

namespace {

// Such a view has most of its image in common with another; an error of a hand's breadth is none of
// a place.
constexpr double kKnown_m = 1.0, kKnown_rad = 40 * M_PI / 180, kFound_m = 0.05;

struct Walk {
  std::string scene = "room";
  int frames = 500;
  double rate_hz = 15;
  int hidden = 60;  // frames
  int runs = 20;
  int seed = 1;
  std::string device;
};

struct Outcome {
  std::int64_t first_hidden = 0;  // frame
  std::int64_t hidden_until = 0;  // first frame that shows something again
  // First frame after that that shows ground from before.
  std::optional<std::int64_t> known_at;
  std::optional<std::int64_t> found_at;              // first frame after that whose pose is right
  std::int64_t lost_count = 0, component_count = 0;  // frames; parts at the end
  std::int64_t weak_count = 0;                       // frames after the camera was hidden
  // Frames that are called tracked and are not right; of the first part of the map.
  std::int64_t wrong_count = 0;
  // Error of the frames that were not lost: the pose of a lost one is only held.
  double ate_mm = 0;
};

std::string source_of(const Walk& walk, int run, const std::string& suffix) {
  return "synthetic:scene=" + walk.scene + ",frames=" + std::to_string(walk.frames) +
         ",width=320,height=240,noise=kinect-white,rate=" + std::to_string(walk.rate_hz) +
         ",seed=" + std::to_string(walk.seed + run) + suffix;
}

bool sees_known_ground(const dataset::Trajectory& truth, std::int64_t frame,
                       std::int64_t known_frames) {
  for (std::int64_t i = 0; i < known_frames; ++i) {
    const Rigid3 motion = inverse(truth[static_cast<std::size_t>(i)].world_from_camera) *
                          truth[static_cast<std::size_t>(frame)].world_from_camera;
    if (motion.translation.norm() < kKnown_m && angle_rad(motion.rotation) < kKnown_rad)
      return true;
  }
  return false;
}

// The suffix leaves the frames' numbers as they are or takes some out: what is compared is found by
// time.
Outcome observe(const Walk& walk, int run, const std::string& suffix, Outcome outcome) {
  const auto sequence = or_throw(source::open_sequence(source_of(walk, run, suffix)));
  const dataset::Trajectory& truth = sequence->groundtruth();
  const pipeline::Options options;
  pipeline::Pipeline pipeline(
      walk.device, sequence->camera(), options,
      adjust::make_mapping(sequence->camera(), options.adjust, adjust::CorrectionTime::kByFrames));
  std::vector<bool> is_lost;
  bool has_parts = false;
  for (std::int64_t i = 0; i < sequence->frame_count(); ++i) {
    const pipeline::FrameResult result =
        or_throw(pipeline.process(or_throw(dataset::decode_frame(or_throw(sequence->read(i))))));
    const auto frame = static_cast<std::int64_t>(
        std::llround((result.timestamp_s - truth.front().timestamp_s) * walk.rate_hz));
    is_lost.push_back(result.status == track::TrackingStatus::kLost);
    outcome.lost_count += is_lost.back() ? 1 : 0;
    const Rigid3 true_pose = inverse(truth.front().world_from_camera) *
                             truth[static_cast<std::size_t>(frame)].world_from_camera;
    const bool is_right =
        (inverse(true_pose) * result.world_from_camera).translation.norm() < kFound_m;
    // Whose places in the world are unknown.
    has_parts = has_parts || result.event == pipeline::MapEvent::kNewPart;
    outcome.wrong_count +=
        result.status == track::TrackingStatus::kTracked && !is_right && !has_parts ? 1 : 0;
    if (frame < outcome.hidden_until) continue;
    outcome.weak_count += result.status == track::TrackingStatus::kWeak ? 1 : 0;
    if (outcome.found_at) continue;
    if (!outcome.known_at && sees_known_ground(truth, frame, outcome.first_hidden))
      outcome.known_at = frame;
    if (outcome.known_at && is_right && !is_lost.back()) outcome.found_at = frame;
  }
  pipeline.finish();
  outcome.component_count = pipeline.statistics().mapping.value().components;
  dataset::Trajectory known;
  for (std::size_t i = 0; i < is_lost.size(); ++i)
    if (!is_lost[i]) known.push_back(pipeline.trajectory()[i]);
  outcome.ate_mm = 1e3 * or_throw(evaluate::trajectory_error(known, truth)).ate_m.rmse;
  return outcome;
}

Outcome kidnap(const Walk& walk, int run) {
  std::mt19937 random(static_cast<unsigned>(walk.seed + run));
  Outcome outcome;
  // Not before there is a map, and not so late that nothing follows.
  outcome.first_hidden =
      walk.hidden +
      static_cast<std::int64_t>(random() % static_cast<unsigned>(walk.frames - 3 * walk.hidden));
  outcome.hidden_until = outcome.first_hidden + walk.hidden;
  const char* how = run % 2 == 0 ? "+covered=" : "+missing=";
  return observe(walk, run,
                 how + std::to_string(outcome.first_hidden) + ":" + std::to_string(walk.hidden),
                 outcome);
}

void print(int run, const Outcome& outcome, double undisturbed_mm) {
  const auto after = [&](const std::optional<std::int64_t>& frame, std::int64_t since) {
    return frame ? std::to_string(*frame - since) : std::string("never");
  };
  std::printf("| %d | %s | %lld | %s | %s | %lld | %lld | %lld | %lld | %.1f | %.1f |\n", run,
              run % 2 == 0 ? "covered" : "missing", static_cast<long long>(outcome.first_hidden),
              after(outcome.known_at, outcome.hidden_until).c_str(),
              after(outcome.found_at, outcome.known_at.value_or(0)).c_str(),
              static_cast<long long>(outcome.lost_count),
              static_cast<long long>(outcome.weak_count),
              static_cast<long long>(outcome.wrong_count),
              static_cast<long long>(outcome.component_count), outcome.ate_mm, undisturbed_mm);
  std::fflush(stdout);
}

int run_program(int argc, char** argv) {
  CLI::App app{"A camera that sees nothing for a while"};
  Walk walk;
  app.add_option("--scene", walk.scene, "room, loop, office, blank")->capture_default_str();
  app.add_option("--frames", walk.frames, "Of a walk")
      ->check(CLI::Range(100, 100000))
      ->capture_default_str();
  app.add_option("--rate", walk.rate_hz, "Frames a second")
      ->check(CLI::Range(1.0, 60.0))
      ->capture_default_str();
  app.add_option("--hidden", walk.hidden, "Frames covered (even runs) or missing (odd ones)")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--runs", walk.runs, "Walks, each with its own time and noise")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", walk.seed, "Of the first walk")->capture_default_str();
  app.add_option("--device", walk.device, "GPU: an index or a part of its name");
  CLI11_PARSE(app, argc, argv);
  if (walk.frames <= 3 * walk.hidden)
    throw SetupError(
        {ErrorCode::kInvalidArgument, "--frames must be more than three times --hidden"});
  std::printf(
      "| run | | from frame | known ground after | found after | frames lost | weak | tracked and "
      "wrong | parts | ATE mm | undisturbed "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (int run = 0; run < walk.runs; ++run) {
    Outcome undisturbed;
    undisturbed.hidden_until = walk.frames;
    print(run, kidnap(walk, run), observe(walk, run, "", undisturbed).ate_mm);
  }
  return 0;
}

}  // namespace

}  // namespace hermite

int main(int argc, char** argv) {
  return hermite::guarded_main("hermite_kidnap", [&] { return hermite::run_program(argc, argv); });
}
