// A recording becomes a result: reconstruct_recording RECORDING EXISTING_FOLDER
#include <exception>
#include <iostream>
#include <stdexcept>

#include "core/dataset/read_frame.h"
#include "core/output/ply.h"
#include "core/run/back_end.h"
#include "core/run/results.h"
#include "core/source/open_sequence.h"

using namespace hermite;

int main(int count, char** arguments) try {
  if (count != 3) throw std::invalid_argument("give a recording and a folder for its result");
  const auto recording = or_throw(source::open_sequence(arguments[1]));
  const pipeline::Options options;
  pipeline::Pipeline pipeline("", recording->camera(), options,
                              run::make_back_end(options, adjust::CorrectionTime::kByFrames));
  for (std::int64_t i = 0; i < recording->frame_count(); ++i) {
    const pipeline::FrameResult result =
        or_throw(pipeline.process(dataset::read_frame(*recording, i).frame));
    if (result.status != track::TrackingStatus::kTracked)
      std::cerr << "frame " << i << ": " << result.reason << '\n';
  }
  pipeline.finish();
  const run::RunResults results =
      or_throw(run::results_of(pipeline, options, recording->groundtruth()));
  for (const auto& [name, bytes] : run::files_of(results))
    or_throw(output::write_file_atomically(std::string(arguments[2]) + "/" + name, bytes));
  std::cout << results.report_json;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
