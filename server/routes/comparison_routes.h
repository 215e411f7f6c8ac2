// The routes for comparisons of two ended scans. http_routes.h has the table. On the network
// thread, except for reading a report, which a disk thread does.
//
// {id} is the first scan, in whose world the result is; {other} is the second. A comparison is made
// like an export (server/exports), and is a file of the first scan. Both scans have to be visible
// for the token; a share link, which shows one scan, gets 403 everywhere.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// The largest report that is sent: some hundred thousand regions.
inline constexpr std::size_t kMaxComparisonReport_bytes = std::size_t{64} << 20;

// {"comparisons": [{"with": ID, "state": "running", "done": 0.4, "words": ""}, ...]}; `state` is
// queued, running, ready or failed.
HttpAnswer list_comparisons(const HttpWorld& world, const Call& call);

// {"with": ID}. 202 with its entry of the list; 200 if it is ready.
HttpAnswer create_comparison(const HttpWorld& world, const Call& call);

// Its entry of the list, with `state` missing if nobody has asked for it; with "report" once it is
// ready (format_comparison_json).
HttpAnswer show_comparison(const HttpWorld& world, const Call& call);

// The points (format_compared_points_ply); 404, with a message, if there are none.
HttpAnswer send_compared_points(const HttpWorld& world, const Call& call);

// Stops or removes it: {"removed": ID}.
HttpAnswer remove_comparison(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
