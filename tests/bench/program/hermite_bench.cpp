// hermite_bench: times of the reconstruction on this machine's GPU. Links nothing but Vulkan,
// Eigen and fmt.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "tests/bench/program/arguments.h"
#include "tests/bench/program/measure.h"
#include "tests/bench/program/pass_costs.h"
#include "tests/bench/program/roofline.h"
#include "tests/bench/program/tables.h"
#include "tests/bench/program/trace.h"

namespace hermite::bench {

namespace {

constexpr int kFailed = 1, kUsage = 2;

std::string heading(const Arguments& arguments, const RawFrameReader& file,
                    const Roofline& roofline) {
  char rates[200];
  std::snprintf(
      rates, sizeof rates, "Reachable: %.1f GB/s of memory, %.0f GFLOP/s%s.\n\n",
      roofline.memory_gb_per_s, roofline.gflop_per_s,
      roofline.has_timestamps
          ? ""
          : " (by wall clock: the device has no time stamps, so no times of passes follow)");
  const Camera& camera = file.camera();
  return "Device " + gpu::as_text(roofline.device) + ". " + rates +
         std::filesystem::path(arguments.file).filename().string() + ": " +
         std::to_string(file.frame_count()) + " frames of " + std::to_string(camera.width) + "x" +
         std::to_string(camera.height) + ". ";
}

std::string frames_as_text(const Measurement& measurement, const Arguments& arguments) {
  const auto tracked = std::count_if(measurement.frames.begin(), measurement.frames.end(),
                                     [](const auto& frame) { return frame.tracked; });
  return std::to_string(measurement.frames.size()) + " frames measured after " +
         std::to_string(arguments.warm_up_count) + " to warm up, " + std::to_string(tracked) +
         " tracked.\n\n";
}

void write_trace_file(const std::string& path, const Measurement& measurement) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  write_trace(file, measurement);
  file.close();
  if (!file) throw SetupError({ErrorCode::kIo, "cannot write " + path});
}

int run(const Arguments& arguments) {
  RawFrameReader file = or_throw(RawFrameReader::open(arguments.file));
  const Roofline roofline = measure_roofline(arguments.device);
  std::cout << heading(arguments, file, roofline) << std::flush;
  const Measurement measurement = measure(file, arguments);
  std::cout << frames_as_text(measurement, arguments)
            << format_tables(measurement, pass_costs(arguments.options), roofline);
  if (!arguments.trace_file.empty()) write_trace_file(arguments.trace_file, measurement);
  return 0;
}

}  // namespace

int run_program(const std::vector<std::string>& words) {
  try {
    const Arguments arguments = or_throw(parse_arguments(words));
    if (!arguments.help) return run(arguments);
    std::cout << help_text();
    return 0;
  } catch (const SetupError& error) {
    std::cerr << "hermite_bench: " << error.what() << '\n';
    return error.error().code == ErrorCode::kInvalidArgument ? kUsage : kFailed;
  } catch (const std::exception& error) {
    std::cerr << "hermite_bench: " << error.what() << '\n';
    return kFailed;
  }
}

}  // namespace hermite::bench

int main(int argc, char** argv) {
  return hermite::bench::run_program({argv + 1, argv + std::max(argc, 1)});
}
