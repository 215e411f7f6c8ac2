#include "tests/bench/program/trace.h"

#include <cstdio>

namespace hermite::bench {

namespace {

constexpr int kHostTrack = 1, kGpuTrack = 2;

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\')
      (json += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20)
      json.append(escaped, static_cast<std::size_t>(std::snprintf(escaped, sizeof escaped, "\\u%04x", c)));
    else
      json += c;
  }
  return json + '"';
}

struct Event {
  std::string name;
  const char* category;
  int track;
  Timeline::Clock::time_point start;
  double duration_ms;
  std::string args = "{}";  // a JSON object
};

class EventWriter {
 public:
  EventWriter(std::ostream& out, Timeline::Clock::time_point zero) : out_(out), zero_(zero) {}

  void name(const std::string& what, int track, const std::string& value) {
    out_ << separator() << R"({"ph":"M","pid":1,"tid":)" << track << R"(,"name":)" << quoted(what) << R"(,"args":{"name":)" << quoted(value)
         << "}}";
  }
  void complete(const Event& event) {
    char times[80];
    std::snprintf(times, sizeof times, "\"ts\":%.3f,\"dur\":%.3f", std::chrono::duration<double, std::micro>(event.start - zero_).count(),
                  1000 * event.duration_ms);
    out_ << separator() << R"({"ph":"X","pid":1,"tid":)" << event.track << ',' << times << R"(,"cat":")" << event.category << R"(","name":)"
         << quoted(event.name) << R"(,"args":)" << event.args << '}';
  }

 private:
  const char* separator() {
    const char* before = first_ ? "" : ",\n";
    first_ = false;
    return before;
  }

  std::ostream& out_;
  const Timeline::Clock::time_point zero_;
  bool first_ = true;
};

}  // namespace

void write_trace(std::ostream& out, const Measurement& measurement) {
  EventWriter events(out, measurement.frames.empty() ? Timeline::Clock::time_point{} : measurement.frames.front().start);
  out << "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
  events.name("process_name", 0, "hermite on " + measurement.statistics.device);
  events.name("thread_name", kHostTrack, "frames and stages");
  events.name("thread_name", kGpuTrack, "GPU passes");
  for (const MeasuredFrame& frame : measurement.frames) {
    events.complete({"frame " + std::to_string(frame.index), "frame", kHostTrack, frame.start, frame.wall_ms,
                     frame.tracked ? R"({"tracked":true})" : R"({"tracked":false})"});
    for (const Timeline::Stage& stage : frame.timeline.stages)
      events.complete({stage.name, "stage", kHostTrack, stage.start, stage.duration_ms});
    for (const Timeline::Pass& pass : frame.timeline.passes)
      events.complete(
          {pass.name, "pass", kGpuTrack, pass.start, pass.duration_ms, R"({"invocations":)" + std::to_string(pass.invocations) + '}'});
  }
  out << "\n]}\n";
}

}  // namespace hermite::bench
