// A trace that chrome://tracing and ui.perfetto.dev can draw: the "JSON Array Format" of Google's
// trace event format, with complete events ("ph": "X") in microseconds. Events of one track that
// overlap without one containing the other are not drawn, so such events need separate tracks.
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

// The constructor writes the start and finish() the end, after which nothing may follow.
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
