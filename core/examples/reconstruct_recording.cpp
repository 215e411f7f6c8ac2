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
  const auto recording = or_throw(open_sequence(arguments[1]));
  const Options options;
  Pipeline pipeline("", recording->camera(), options, make_back_end(options, CorrectionTime::kByFrames));
  for (std::int64_t i = 0; i < recording->frame_count(); ++i) {
    const FrameResult result = or_throw(pipeline.process(read_frame(*recording, i).frame));
    if (result.status != TrackingStatus::kTracked) std::cerr << "frame " << i << ": " << result.reason << '\n';
  }
  pipeline.finish();
  const RunResults results = or_throw(results_of(pipeline, options, recording->groundtruth()));
  for (const auto& [name, bytes] : files_of(results)) or_throw(write_file_atomically(std::string(arguments[2]) + "/" + name, bytes));
  std::cout << results.report_json;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
