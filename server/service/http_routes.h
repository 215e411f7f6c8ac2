// What the server answers over HTTP, apart from sockets: a table of routes. A new route is one row and one function. On the network thread.
//
//                                             scope
//   GET    /healthz                           -      "ok": this thread answers (more is told on the admin address, see admin.h)
//   GET    /api/v1/scans                      view   {"scans": [...]}, newest first; for a share link only its scan
//   GET    /api/v1/scans/{id}                 view   one of them
//   DELETE /api/v1/scans/{id}                 admin  a scan that has ended, with its files
//   GET    /api/v1/scans/{id}/cloud.ply       view   and trajectory.txt, report.json: files of a scan that has ended
//   GET    /api/v1/scans/{id}/shares          scan   its share links (scan and view: who cannot see a scan cannot share it)
//   POST   /api/v1/scans/{id}/shares          scan   a new one (administration.h has the bodies)
//   GET    /api/v1/shares                     scan   all
//   DELETE /api/v1/shares/{id}                scan   revoked
//   GET    /api/v1/tokens                     admin
//   POST   /api/v1/tokens                     admin  a new one
//   DELETE /api/v1/tokens/{id}                admin  revoked
//   GET    /...                               -      the viewer's files
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/service/gate.h"
#include "server/service/metrics.h"
#include "server/service/scans.h"
#include "server/service/static_files.h"

namespace hermite {

struct HttpRequest {
  std::string method;         // "GET", "HEAD", "DELETE", ...
  std::string path;           // without query
  std::string query;          // what follows the ?
  std::string authorization;  // the header's value
  std::string body;           // of a POST
  Caller caller;              // who asks
};

struct HttpAnswer {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string cache_control = "no-store";
  std::string body;
  std::string file;                  // path of a file to send instead of `body`
  std::string download_name;         // of an attachment
  std::string allow;                 // methods, with status 405
  std::int64_t retry_after_s = 0;    // with status 429 and 503
  std::string_view route = "other";  // for metrics, never what a client wrote
};

struct HttpWorld {
  Scans& scans;
  Store& store;
  Gate& gate;
  const StaticFiles& files;
  Metrics& metrics;
};

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request);

// {"error": {"code": ..., "message": ...}}
HttpAnswer error_answer(int status, const Error& error);

// 429 or 503 with Retry-After.
HttpAnswer wait_answer(int status, const std::string& words, std::int64_t retry_in_ms);

}  // namespace hermite
