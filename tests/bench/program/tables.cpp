#include "tests/bench/program/tables.h"

#include <algorithm>
#include <numeric>

#include "core/base/printf_text.h"

namespace hermite::bench {

namespace {

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}
double median(const std::vector<double>& values) { return percentile(values, 0.5); }

// The entry of this name; `fresh` becomes it where there is none.
template <class Entry>
Entry& entry_of(std::vector<Entry>& entries, const Entry& fresh) {
  const auto known = std::find_if(entries.begin(), entries.end(), [&fresh](const Entry& entry) {
    return entry.name == fresh.name;
  });
  return known != entries.end() ? *known : entries.emplace_back(fresh);
}

std::string time_row(const Series& series) {
  return printf_text("| %s | %.2f | %.2f | %.2f |\n", series.name.c_str(), median(series.values),
                     percentile(series.values, 0.95), percentile(series.values, 1));
}

std::string format_frame_times(const Measurement& measurement,
                               const std::vector<PassSeries>& passes) {
  Series wall{"frame, wall clock", {}},
      gpu{"GPU passes together", std::vector<double>(measurement.frames.size())};
  for (const MeasuredFrame& frame : measurement.frames) wall.values.push_back(frame.wall_ms);
  for (const PassSeries& pass : passes)
    for (std::size_t i = 0; i < gpu.values.size(); ++i) gpu.values[i] += pass.gpu_ms[i];
  std::string table = "| ms a frame | median | p95 | max |\n|---|---|---|---|\n" + time_row(wall);
  for (const Series& stage : stage_times_ms(measurement)) table += time_row(stage);
  return table + time_row(gpu) + "\n";
}

std::string format_passes(const std::vector<PassSeries>& passes) {
  double all_ms = 0;
  for (const PassSeries& pass : passes) all_ms += sum(pass.gpu_ms);
  std::string table =
      "| GPU pass, ms a frame | dispatches | median | p95 | share [%] | bound | by | times its "
      "bound "
      "|\n|---|---|---|---|---|---|---|---|\n";
  for (const PassSeries& pass : passes) {
    table +=
        printf_text("| %s | %.0f | %.3f | %.3f | %.1f ", pass.name.c_str(), median(pass.dispatches),
                    median(pass.gpu_ms), percentile(pass.gpu_ms, 0.95),
                    all_ms > 0 ? 100 * sum(pass.gpu_ms) / all_ms : 0);
    const double bound_ms = sum(pass.bound_ms);
    if (bound_ms > 0)
      table += printf_text("| %.4f | %s | %.1f |\n", median(pass.bound_ms),
                           pass.memory_ms > pass.arithmetic_ms ? "memory" : "arithmetic",
                           sum(pass.gpu_ms) / bound_ms);
    else
      table += "| – | – | – |\n";
  }
  return table + "\n";
}

std::string format_memory(const pipeline::PipelineStatistics& statistics) {
  std::string table = "| device memory | MB |\n|---|---|\n";
  double all_bytes = 0;
  for (const auto& [purpose, bytes] : statistics.gpu_memory_bytes) {
    table += printf_text("| %s | %.2f |\n", purpose.c_str(), static_cast<double>(bytes) / 1e6);
    all_bytes += static_cast<double>(bytes);
  }
  return table + printf_text("| all | %.2f |\n\n", all_bytes / 1e6);
}

std::string format_surfels(const pipeline::PipelineStatistics& statistics) {
  const auto map = statistics.gpu_memory_bytes.find("map");
  const double map_bytes =
      map == statistics.gpu_memory_bytes.end() ? 0 : static_cast<double>(map->second);
  const auto each = [map_bytes](std::int64_t count) {
    return count > 0 ? map_bytes / static_cast<double>(count) : 0;
  };
  return "| surfels | count | bytes of the map each |\n|---|---|---|\n" +
         printf_text("| alive | %lld | %.1f |\n", static_cast<long long>(statistics.surfel_count),
                     each(statistics.surfel_count)) +
         printf_text("| slots in use | %lld | %.1f |\n",
                     static_cast<long long>(statistics.surfel_slot_count),
                     each(statistics.surfel_slot_count)) +
         printf_text("| slots there is memory for | %lld | %.1f |\n",
                     static_cast<long long>(statistics.surfel_capacity),
                     each(statistics.surfel_capacity));
}

}  // namespace

std::vector<Series> stage_times_ms(const Measurement& measurement) {
  std::vector<Series> stages;
  const std::size_t frame_count = measurement.frames.size();
  for (std::size_t i = 0; i < frame_count; ++i)
    for (const Timeline::Stage& stage : measurement.frames[i].timeline.stages)
      entry_of(stages, {stage.name, std::vector<double>(frame_count)}).values[i] +=
          stage.duration_ms;
  return stages;
}

std::vector<PassSeries> pass_times(const Measurement& measurement,
                                   const std::vector<PassCost>& costs, const Roofline& roofline) {
  std::vector<PassSeries> passes;
  const std::size_t frame_count = measurement.frames.size();
  const std::vector<double> zeros(frame_count);
  for (std::size_t i = 0; i < frame_count; ++i)
    for (const Timeline::Pass& pass : measurement.frames[i].timeline.passes) {
      PassSeries& series = entry_of(passes, {pass.name, zeros, zeros, zeros});
      const PassBound bound = bound_of(pass, costs, roofline);
      series.dispatches[i] += 1;
      series.gpu_ms[i] += pass.duration_ms;
      series.bound_ms[i] += std::max(bound.memory_ms, bound.arithmetic_ms);
      series.memory_ms += bound.memory_ms;
      series.arithmetic_ms += bound.arithmetic_ms;
    }
  std::stable_sort(passes.begin(), passes.end(), [](const PassSeries& a, const PassSeries& b) {
    return sum(a.gpu_ms) > sum(b.gpu_ms);
  });
  return passes;
}

std::string format_tables(const Measurement& measurement, const std::vector<PassCost>& costs,
                          const Roofline& roofline) {
  const std::vector<PassSeries> passes = pass_times(measurement, costs, roofline);
  return format_frame_times(measurement, passes) + format_passes(passes) +
         format_memory(measurement.statistics) + format_surfels(measurement.statistics);
}

}  // namespace hermite::bench
