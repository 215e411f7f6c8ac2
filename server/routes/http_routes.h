// What the server answers over HTTP, apart from sockets: a table of routes. A new route is one row and one function. On the network thread.
//
//                                             scope
//   GET    /healthz                           -      "ok": this thread answers (more is told on the admin address, see admin.h)
//   GET    /api/v1/access                     any    what whoever asks may do (scan_routes.h has this and the next two)
//   PATCH  /api/v1/scans/{id}                 scan   another title; of its own, or admin (scan and view)
//   POST   /api/v1/scans/{id}/stop            scan   a scan that runs ends; the same
//   GET    /api/v1/scans                      view   {"scans": [...]}, newest first; for a share link only its scan
//   GET    /api/v1/scans/{id}                 view   one of them
//   DELETE /api/v1/scans/{id}                 admin  a scan that has ended, with its files
//   GET    /api/v1/scans/{id}/cloud.ply       view   and trajectory.txt, report.json: files of a scan that has ended
//   GET    /api/v1/scans/{id}/exports         view   what a scan that has ended can be taken away as (export_routes.h has these)
//   POST   /api/v1/scans/{id}/exports         view   {"format": ...} is made
//   GET    /api/v1/scans/{id}/exports/{format}     view
//   DELETE /api/v1/scans/{id}/exports/{format}     scan   stopped, or removed (scan and view)
//   POST   /api/v1/scans/{id}/measure         view   a measurement in a scan that has ended (measure_routes.h has these)
//   GET    /api/v1/scans/{id}/measurements    view   those that were kept, and as measurements.csv
//   POST   /api/v1/scans/{id}/measurements    scan   something is measured and kept; of its own, or admin (scan and view)
//   DELETE /api/v1/scans/{id}/measurements/{measurement}  scan  the same
//   GET    /api/v1/scans/{id}/frames          view   what the camera has sent, of a scan that has ended (frame_routes.h has these); no link
//   GET    /api/v1/scans/{id}/frames/color/{frame}    view   one of its images, and depth/{frame}, depth16/{frame}
//   GET    /api/v1/scans/{id}/shares          scan   its share links (scan and view: who cannot see a scan cannot share it)
//   POST   /api/v1/scans/{id}/shares          scan   a new one (administration.h has the bodies)
//   GET    /api/v1/shares                     scan   all
//   DELETE /api/v1/shares/{id}                scan   revoked
//   GET    /api/v1/tokens                     admin
//   POST   /api/v1/tokens                     admin  a new one
//   DELETE /api/v1/tokens/{id}                admin  revoked
//   GET    /api/v1/uploads                    scan   its own uploads (upload_routes.h has these)
//   OPTIONS /api/v1/uploads                   scan   what of tus there is
//   POST   /api/v1/uploads                    scan   a new one, by tus
//   PUT    /api/v1/uploads/{name}             scan   a recording in one request
//   HEAD, PATCH, DELETE /api/v1/uploads/{id}  scan   by tus: how much is there, more of it, away with it
//   GET    /api/v1/jobs                       scan   newest first; without view only its own
//   POST   /api/v1/jobs                       scan   a stored scan anew (scan and view; job_request.h has the body)
//   GET    /api/v1/jobs/{id}                  scan   with its log
//   DELETE /api/v1/jobs/{id}                  scan   cancelled; its own, or admin
//   POST   /api/v1/jobs/{id}/retry            scan   one that has failed or was cancelled; its own, or admin
//   GET    /...                               -      the viewer's files
//
// server/README.md has all of this for people who write clients.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/access/audit.h"
#include "server/access/gate.h"
#include "server/access/rate_limit.h"
#include "server/jobs/executor.h"
#include "server/operations/metrics.h"
#include "server/routes/body_sink.h"
#include "server/routes/measuring_cache.h"
#include "server/routes/static_files.h"
#include "server/scan/scans.h"
#include "server/uploads/tus.h"
#include "server/uploads/uploads.h"

namespace hermite {

class Exports;

struct HttpRequest {
  std::string method;            // "GET", "HEAD", "DELETE", ...
  std::string path;              // without query
  std::string query;             // what follows the ?
  std::string authorization;     // the header's value
  std::string body;              // of a POST
  Caller caller;                 // who asks
  HttpHeaders headers = {};      // all of them
  std::uint64_t body_bytes = 0;  // announced
  bool asked_again = false;      // by the server itself (HttpAnswer::ask_again): it counts for no rate
};

// A long body that lies somewhere, and is read while it is sent.
struct StoredBody {
  std::uint64_t size_bytes = 0;                                                          // to send
  std::function<Result<std::string>(std::uint64_t offset, std::size_t max_bytes)> read;  // on another thread; what it needs outlives it
  std::uint64_t first_byte = 0;
};

struct HttpAnswer {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string cache_control = "no-store";
  std::string body;
  std::optional<StoredBody> stored;  // to send instead of `body`
  std::string download_name;         // of an attachment
  std::string allow;                 // methods, with status 405
  std::int64_t retry_after_s = 0;    // with status 429 and 503
  std::string_view route = "other";  // for metrics, never what a client wrote
  HttpHeaders headers = {};          // besides those that every answer has
  // Instead of all that: the body of the request goes there, and the answer comes from there.
  std::shared_ptr<BodySink> body_sink = nullptr;
  // Instead of all that: makes the answer on a thread for the disk. What it needs outlives it.
  std::function<HttpAnswer()> work = nullptr;
  // Somebody else has to let go first; the same request may be made again in a moment. If that does not help, this is the answer.
  bool ask_again = false;
};

struct HttpWorld {
  Scans& scans;
  Store& store;
  Gate& gate;
  const StaticFiles& files;
  Metrics& metrics;
  Uploads& uploads;
  Executor& executor;
  ShareCount& sessions;   // WebSockets
  RateLimit& of_a_token;  // requests
  Audit& audit;
  Exports& exports;
  MeasuringCache& measuring;
};

// What a route's function gets besides the world.
struct Call {
  const HttpRequest& request;
  const Grant& grant;
  std::string id;         // inside the path, for a route that has one
  std::string last_part;  // behind it, the same
};

// Whether the body of such a request may be long, so that only its answer says where it goes.
bool takes_long_body(const HttpRequest& request);

// "GET /api/v1/scans/{id}", one for each route of the API.
std::vector<std::string> api_routes();

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request);

// A file of a scan that has ended, or the part of it that is asked for.
HttpAnswer send_file(const HttpWorld& world, const Call& call, const std::string& name, const char* content_type);

// {"error": {"code": ..., "message": ...}}
HttpAnswer error_answer(int status, const Error& error);

// {"error": ...} with the status that goes with the code.
HttpAnswer refused(const Error& error);

// JSON that is text already, or why there is none.
HttpAnswer made(Result<std::string> json, int status = 200);

// 429 or 503 with Retry-After.
HttpAnswer wait_answer(int status, const std::string& words, std::int64_t retry_in_ms);

}  // namespace hermite
