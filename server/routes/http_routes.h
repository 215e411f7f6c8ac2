// The routes of the HTTP API, independent of sockets, as a table. A new route needs one row and one
// function. On the network thread. (*): the scope view is needed as well.
//
//                                              scope
//   GET     /healthz                          -      "ok": the server runs (admin.h tells more)
//   GET     /api/v1/access                    any    the permissions of the token
//   PATCH   /api/v1/scans/{id}                scan   sets title and tags; of its own, or admin (*)
//   POST    /api/v1/scans/{id}/stop           scan   ends a running scan; the same
//   POST    /api/v1/scans/{id}/pause          scan   asks its camera to pause; the same
//   POST    /api/v1/scans/{id}/unpause        scan   asks its camera to go on; the same
//   GET     /api/v1/scans                     view   newest first; for a share link only its scan
//   GET     /api/v1/scans/{id}                view   one of them
//   DELETE  /api/v1/scans/{id}                admin  deletes an ended scan with its files
//   GET     /api/v1/scans/{id}/cloud.ply      view   of an ended scan
//   GET     /api/v1/scans/{id}/trajectory.txt view   the same
//   GET     /api/v1/scans/{id}/report.json    view   the same
//   GET     /api/v1/scans/{id}/thumbnail.jpg  view   the same
//   GET     /api/v1/scans/{id}/exports        view   the exports of an ended scan
//   POST    /api/v1/scans/{id}/exports        view   makes {"format": ...}
//   GET     /api/v1/scans/{id}/exports/{format}  view  its file
//   DELETE  /api/v1/scans/{id}/exports/{format}  scan  cancels or removes it (*)
//   GET     /api/v1/scans/{id}/comparisons    view   with other scans; none is for share links
//   POST    /api/v1/scans/{id}/comparisons    scan   makes {"with": ...} (*)
//   GET     /api/v1/scans/{id}/comparisons/{other}  view  with its report
//   GET     /api/v1/scans/{id}/compared-points/{other}  view  the points of both
//   DELETE  /api/v1/scans/{id}/comparisons/{other}  scan  cancels or removes it (*)
//   POST    /api/v1/scans/{id}/measure        view   measures in an ended scan
//   GET     /api/v1/scans/{id}/measurements   view   saved ones
//   POST    /api/v1/scans/{id}/measurements   scan   measures and saves; of its own, or admin (*)
//   GET     /api/v1/scans/{id}/measurements.csv  view  saved ones
//   DELETE  /api/v1/scans/{id}/measurements/{measurement}  scan  of its own, or admin (*)
//   GET     /api/v1/scans/{id}/notes          view   what people have written at places of it
//   POST    /api/v1/scans/{id}/notes          scan   writes one; of its own, or admin (*)
//   PATCH   /api/v1/scans/{id}/notes/{note}   scan   changes its text; the same
//   DELETE  /api/v1/scans/{id}/notes/{note}   scan   removes it; the same
//   GET     /api/v1/scans/{id}/edits          view   what was taken out of it
//   PUT     /api/v1/scans/{id}/edits          scan   replaces them; of its own, or admin (*)
//   GET     /api/v1/scans/{id}/frames         view   of an ended scan; none is for share links
//   GET     /api/v1/scans/{id}/frames/color/{frame}  view  an image, also while it runs
//   GET     /api/v1/scans/{id}/frames/depth/{frame}  view  its depth in colours
//   GET     /api/v1/scans/{id}/frames/depth16/{frame}  view  its depth
//   GET     /api/v1/scans/{id}/shares         scan   its share links (*)
//   POST    /api/v1/scans/{id}/shares         scan   a new one (*)
//   GET     /api/v1/shares                    scan   all (*)
//   DELETE  /api/v1/shares/{id}               scan   revokes it (*)
//   GET     /api/v1/tokens                    admin  all
//   POST    /api/v1/tokens                    admin  a new one
//   DELETE  /api/v1/tokens/{id}               admin  revokes it
//   GET     /api/v1/uploads                   scan   its own uploads
//   OPTIONS /api/v1/uploads                   scan   supported parts of tus
//   POST    /api/v1/uploads                   scan   a new one, by tus
//   HEAD    /api/v1/uploads/{id}              scan   by tus: its offset
//   PATCH   /api/v1/uploads/{id}              scan   by tus: more bytes
//   DELETE  /api/v1/uploads/{id}              scan   by tus: removal
//   PUT     /api/v1/uploads/{name}            scan   a recording in one request
//   GET     /api/v1/jobs                      scan   newest first; without view only its own
//   POST    /api/v1/jobs                      scan   processes a stored scan again (*)
//   GET     /api/v1/jobs/{id}                 scan   with its log
//   DELETE  /api/v1/jobs/{id}                 scan   cancels it; its own, or admin
//   POST    /api/v1/jobs/{id}/retry           scan   tries a failed or cancelled one again
//   GET     /...                              -      the viewer's files
//
// The functions are in a *_routes.h for each group, which has their errors; the bodies of requests
// are in server/jobs/job_request.h and server/access/administration.h where they are not there.
// server/README.md documents all of this for authors of clients.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/access/access.h"
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

namespace hermite::server {

class Exports;

struct HttpRequest {
  std::string method;            // "GET", "HEAD", "DELETE", ...
  std::string path;              // without query
  std::string query;             // after the "?"
  std::string authorization;     // value of the header
  std::string body;              // of a POST or PATCH; a long one goes to HttpAnswer::body_sink
  Caller caller;                 // the client
  HttpHeaders headers = {};      // all of them
  std::uint64_t body_bytes = 0;  // announced length
  // Repeated by the server itself (HttpAnswer::ask_again): not rate limited again.
  bool asked_again = false;
};

// A long body that is read from storage while it is sent.
struct StoredBody {
  std::uint64_t size_bytes = 0;  // to be sent
  // Called on another thread. What it uses outlives it.
  std::function<Result<std::string>(std::uint64_t offset, std::size_t max_bytes)> read;
  std::uint64_t first_byte = 0;
};

struct HttpAnswer {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string cache_control = "no-store";
  std::string body;
  std::optional<StoredBody> stored;  // sent instead of `body`
  std::string download_name;         // file name of an attachment
  std::string allow;                 // allowed methods, with status 405
  std::int64_t retry_after_s = 0;    // with status 429 and 503
  std::string_view route = "other";  // for metrics; never text from a client
  HttpHeaders headers = {};          // besides those of every answer
  // Instead of the above: receives the body of the request, then makes the answer.
  std::shared_ptr<BodySink> body_sink = nullptr;
  // Instead of the above: makes the answer on a disk thread. What it uses outlives it.
  std::function<HttpAnswer()> work = nullptr;
  std::string frame_ancestors = std::string(kNoFrames);  // access.h
  // Another request is in the way; the same request may be repeated in a moment. If that does not
  // help, this is the answer.
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
  RateLimit& of_a_token;  // requests per token
  Audit& audit;
  Exports& exports;
  MeasuringCache& measuring;
  std::string frame_ancestors;  // which pages may show the viewer in a frame, access.h
};

// What the function of a route gets besides the world.
struct Call {
  const HttpRequest& request;
  const Grant& grant;
  std::string id;         // the id in the path, if the route has one
  std::string last_part;  // the path component after it, if the route has one
};

// Returns whether such a request may have a long body, which is received only once its answer names
// a sink.
bool takes_long_body(const HttpRequest& request);

// Returns the routes of the API, each like "GET /api/v1/scans/{id}".
std::vector<std::string> api_routes();

HttpAnswer answer(const HttpWorld& world, const HttpRequest& request);

// {"error": {"code": ..., "message": ...}}
HttpAnswer error_answer(int status, const Error& error);

// {"error": ...} with the status that corresponds to the error code.
HttpAnswer refused(const Error& error);

// Answers with text that is JSON already, or with its error.
HttpAnswer made(Result<std::string> json, int status = 200);

// 429 or 503 with Retry-After.
HttpAnswer wait_answer(int status, const std::string& message, std::int64_t retry_in_ms);

}  // namespace hermite::server
