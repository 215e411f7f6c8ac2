// hermite inspect and hermite convert
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>

#include "core/dataset/frame_range.h"
#include "core/dataset/write_frame_log.h"
#include "core/dataset/write_klg.h"
#include "core/dataset/write_raw.h"
#include "core/dataset/write_tum.h"
#include "core/evaluate/inspection.h"
#include "core/source/open_sequence.h"
#include "server/commands.h"

namespace hermite::commands {
namespace {

struct InspectArguments {
  std::string path;
  std::string camera;
  bool json = false;
};

std::optional<Camera> camera_of(const std::string& argument) {
  if (argument.empty()) return std::nullopt;
  return or_throw(dataset::read_camera(argument));
}

int run_inspect(const InspectArguments& arguments) {
  const dataset::Recording recording =
      or_throw(dataset::open_recording(arguments.path, camera_of(arguments.camera)));
  const evaluate::Inspection inspection = evaluate::inspect(recording, arguments.path);
  std::cout << (arguments.json ? evaluate::inspection_json(inspection)
                               : evaluate::inspection_text(inspection));
  return 0;
}

struct ConvertArguments {
  std::string source;
  std::string out;
  std::string to;
  std::string frames;
  std::string camera;
};

using Write = Result<dataset::WriteSummary> (*)(const dataset::Sequence& sequence,
                                                dataset::FrameRange range, const std::string& path,
                                                const dataset::WriteProgress& progress);
const std::map<std::string, Write>& writers() {
  static const std::map<std::string, Write> table{{"tum", dataset::write_tum},
                                                  {"log", dataset::write_frame_log},
                                                  {"klg", dataset::write_klg},
                                                  {"raw", dataset::write_raw}};
  return table;
}

int run_convert(const ConvertArguments& arguments) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(arguments.source, camera_of(arguments.camera)));
  const dataset::FrameRange range =
      or_throw(dataset::parse_frame_range(arguments.frames, sequence->frame_count()));
  const dataset::WriteProgress silent = [](std::int64_t) {};
  const dataset::WriteSummary summary =
      or_throw(writers().at(arguments.to)(*sequence, range, arguments.out, silent));
  for (const std::string& remark : summary.remarks) std::cerr << remark << '\n';
  std::cout << summary.frame_count << " frames in " << arguments.out << '\n';
  return 0;
}

}  // namespace

Command add_inspect_command(CLI::App& app) {
  auto arguments = std::make_shared<InspectArguments>();
  CLI::App& inspect =
      *app.add_subcommand("inspect", "Say what a recording is and what may be wrong with it");
  inspect.add_option("PATH", arguments->path, "Folder, file or archive")->required();
  inspect.add_option("--camera", arguments->camera,
                     "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
  inspect.add_flag("--json", arguments->json, "As one JSON object");
  return {&inspect, [arguments] { return run_inspect(*arguments); }};
}

Command add_convert_command(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App& convert = *app.add_subcommand("convert", "Write a recording in another format");
  convert.add_option("SEQUENCE", arguments->source, "What hermite reconstruct takes")->required();
  convert.add_option("OUT", arguments->out, "A new folder (tum, log) or file (klg, raw)")
      ->required();
  convert
      .add_option("--to", arguments->to,
                  "tum (nothing is lost), log (our frame log), klg (millimetres and microseconds), "
                  "raw (decoded)")
      ->required()
      ->check(CLI::IsMember(writers()));
  convert.add_option("--frames", arguments->frames, "A:B takes frames A to B-1");
  convert.add_option("--camera", arguments->camera,
                     "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
  return {&convert, [arguments] { return run_convert(*arguments); }};
}

}  // namespace hermite::commands
