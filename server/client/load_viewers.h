// The viewers of a load test: many connections on a few threads. Each watches the running scan that
// has the fewest viewers, to its end, then the next; it acknowledges what it receives as a browser
// that keeps up does, and discards it.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <vector>

#include "server/client/load_scans.h"
#include "server/client/load_statistics.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite::client {

struct LoadViewersPlan {
  ServerUrl server;        // with its token
  server::TlsContext tls;  // nullptr: not encrypted
  int count = 0;
  std::chrono::duration<double> ramp{0};       // viewer i of n begins after ramp i / n
  std::chrono::milliseconds patience{10'000};  // for each connection
};

class LoadViewers {
 public:
  // `scans` and `watching`, which counts the viewers that watch a scan, must outlive this.
  LoadViewers(const LoadViewersPlan& plan, LoadScans& scans, std::atomic<int>& watching);
  ~LoadViewers();  // as stop()
  LoadViewers(const LoadViewers&) = delete;
  LoadViewers& operator=(const LoadViewers&) = delete;

  // Closes all connections, which takes some seconds at most, and returns what was measured until
  // then. Only once.
  ViewerLoad stop();

 private:
  class Group;
  std::vector<std::unique_ptr<Group>> groups_;  // one for each thread
};

// Returns how many threads serve so many viewers: one for 250, but no more than there are cores.
int load_viewer_threads(int viewers, int cores);

}  // namespace hermite::client
