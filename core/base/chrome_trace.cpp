#include "core/base/chrome_trace.h"

#include <cstdio>

namespace hermite {

namespace {

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\')
      (json += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20)
      json.append(escaped,
                  static_cast<std::size_t>(std::snprintf(escaped, sizeof escaped, "\\u%04x", c)));
    else
      json += c;
  }
  return json + '"';
}

}  // namespace

ChromeTrace::ChromeTrace(std::ostream& out, Timeline::Clock::time_point zero)
    : out_(out), zero_(zero) {
  out_ << "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
}

void ChromeTrace::name_process(const std::string& value) { name("process_name", 0, value); }
void ChromeTrace::name_track(int track, const std::string& value) {
  name("thread_name", track, value);
}

void ChromeTrace::name(const char* what, int track, const std::string& value) {
  out_ << separator() << R"({"ph":"M","pid":1,"tid":)" << track << R"(,"name":)" << quoted(what)
       << R"(,"args":{"name":)" << quoted(value) << "}}";
}

void ChromeTrace::add(const TraceEvent& event) {
  char times[80];
  std::snprintf(times, sizeof times, "\"ts\":%.3f,\"dur\":%.3f",
                std::chrono::duration<double, std::micro>(event.start - zero_).count(),
                1000 * event.duration_ms);
  out_ << separator() << R"({"ph":"X","pid":1,"tid":)" << event.track << ',' << times
       << R"(,"cat":")" << event.category << R"(","name":)" << quoted(event.name) << R"(,"args":)"
       << event.args << '}';
}

void ChromeTrace::finish() { out_ << "\n]}\n"; }

const char* ChromeTrace::separator() {
  const char* before = first_ ? "" : ",\n";
  first_ = false;
  return before;
}

}  // namespace hermite
