// What the server answers over HTTP, apart from sockets: a table of routes. A new route is one row and one function. On the network thread.
//
//   GET    /healthz                           "ok": this thread answers (more is told on the admin address, see admin.h)
//   GET    /api/v1/scans                      {"scans": [...]}, newest first        (these and the next need the token)
//   GET    /api/v1/scans/{id}                 one of them
//   DELETE /api/v1/scans/{id}                 a scan that has ended, with its files
//   GET    /api/v1/scans/{id}/cloud.ply       and trajectory.txt, report.json: files of a scan that has ended
//   GET    /...                               the viewer's files
#pragma once

#include <string>
#include <string_view>

#include "server/net/peer.h"
#include "server/service/scans.h"
#include "server/service/static_files.h"

namespace hermite {

struct HttpRequest {
  std::string method;         // "GET", "HEAD", "DELETE", ...
  std::string path;           // without query
  std::string query;          // what follows the ?
  std::string authorization;  // the header's value
  Peer peer;                  // who asks
};

struct HttpAnswer {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string cache_control = "no-store";
  std::string body;
  std::string file;                  // path of a file to send instead of `body`
  std::string download_name;         // of an attachment
  std::string allow;                 // methods, with status 405
  std::string_view route = "other";  // for metrics, never what a client wrote
};

struct HttpWorld {
  Scans& scans;
  const std::string& token;
  const StaticFiles& files;
  Metrics& metrics;
};

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request);

// {"error": {"code": ..., "message": ...}}
HttpAnswer error_answer(int status, const Error& error);

}  // namespace hermite
