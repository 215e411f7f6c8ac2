// A trace that chrome://tracing and ui.perfetto.dev draw: the "JSON Array Format" of Google's trace event format, complete events ("ph":
// "X") in microseconds. Events of one track that overlap without one lying inside the other are not drawn: give those tracks of their own.
#pragma once

#include <ostream>
#include <string>

#include "core/base/timeline.h"

namespace hermite {

struct TraceEvent {
  std::string name;
  const char* category = "";
  int track = 1;
  Timeline::Clock::time_point start;
  double duration_ms = 0;
  std::string args = "{}";  // a JSON object
};

// Writes the head when it is made; finish() writes the end, and nothing may follow.
class ChromeTrace {
 public:
  ChromeTrace(std::ostream& out, Timeline::Clock::time_point zero);

  void name_process(const std::string& name);
  void name_track(int track, const std::string& name);
  void add(const TraceEvent& event);
  void finish();

 private:
  void name(const char* what, int track, const std::string& value);
  const char* separator();

  std::ostream& out_;
  const Timeline::Clock::time_point zero_;
  bool first_ = true;
};

}  // namespace hermite
