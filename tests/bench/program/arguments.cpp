#include "tests/bench/program/arguments.h"

#include <charconv>
#include <functional>

namespace hermite::bench {

namespace {

constexpr std::int64_t kMostFrames = 1'000'000, kMostSurfels = 16'000'000;

Error usage_error(const std::string& message) {
  return {ErrorCode::kInvalidArgument, message + "; --help says more"};
}

struct Range {
  std::int64_t low = 0, high = kMostFrames;
};

Status parse_count(const std::string& option, const std::string& text, Range range,
                   std::int64_t& count) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, count);
  if (error == std::errc() && stop == end && count >= range.low && count <= range.high)
    return Done{};
  return usage_error(option + " is '" + text + "', allowed is " + std::to_string(range.low) +
                     " to " + std::to_string(range.high));
}

Status parse_setting(const std::string& text, pipeline::Options& options) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    return usage_error("--set is '" + text + "', expected key=value");
  return pipeline::apply_setting(options, text.substr(0, equals), text.substr(equals + 1));
}

Status set_option(const std::string& option, const std::string& value, Arguments& arguments) {
  if (option == "--frames") return parse_count(option, value, {1}, arguments.frame_count);
  if (option == "--warm-up") return parse_count(option, value, {0}, arguments.warm_up_count);
  if (option == "--elsewhere")
    return parse_count(option, value, {0, kMostSurfels}, arguments.elsewhere_count);
  if (option == "--set") return parse_setting(value, arguments.options);
  if (option == "--device")
    arguments.device = value;
  else if (option == "--trace")
    arguments.trace_file = value;
  else
    return usage_error("there is no option " + option);
  return Done{};
}

}  // namespace

Result<Arguments> parse_arguments(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--help" || word == "-h") {
      arguments.help = true;
      return arguments;
    }
    if (!word.starts_with("--")) {
      if (!arguments.file.empty())
        return usage_error("one FILE at a time, not " + arguments.file + " and " + word);
      arguments.file = word;
      continue;
    }
    const std::size_t equals = word.find('=');  // --frames=20 and --frames 20
    const bool joined = equals != std::string::npos;
    if (!joined && i + 1 == words.size()) return usage_error(word + " wants a value");
    const std::string value = joined ? word.substr(equals + 1) : words[++i];
    if (Status status = set_option(word.substr(0, equals), value, arguments); !status.ok())
      return status.error();
  }
  if (arguments.file.empty()) return usage_error("which FILE of raw frames?");
  return arguments;
}

std::string help_text() {
  return R"(hermite_bench: how fast this device reconstructs, pass by pass

  hermite_bench FILE [options]

FILE is what `hermite reconstruct SEQUENCE --dump-raw FILE` writes. Prints Markdown )"
         R"(tables: times a frame (median, 95th percentile, most),
times of every GPU pass beside what the device's memory and arithmetic would allow, )"
         R"(memory by purpose, surfels.

  --frames N       frames to measure (default: all of the file, at least )" +
         std::to_string(kFewestFrames) + R"()
                   A file that is too short is played forwards and backwards.
  --warm-up N      frames before them that are not counted (default: )" +
         std::to_string(Arguments{}.warm_up_count) + R"()
  --elsewhere N    surfels of places out of view that the map has from the start (default: 0)
  --device D       GPU: an index or a part of its name (default: the best one)
  --set KEY=VALUE  a setting, as for `hermite reconstruct`; may be repeated
  --trace FILE     writes every frame, stage and GPU pass for chrome://tracing and ui.perfetto.dev
  --help
)";
}

}  // namespace hermite::bench
