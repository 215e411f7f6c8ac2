// Measuring in ended scans over HTTP, and saved measurements. http_routes.h has the table. On the
// network thread, except for reading surfels, which a disk thread does while the request waits: the
// first measurement in a scan takes about as long as a download of surfels.ply, the next ones some
// milliseconds (measuring_cache.h).
//
// The body of both POSTs is {"kind": ..., "points": [[x, y, z], ...]} (core/measure/quantity.h has
// the kinds), in metres in the world frame of the scan, with points on or near surfaces; for a
// height also "up", a unit vector; to save it also "name", 1 to 200 bytes. What is wrong with a
// point is an error 400 that names it (core/measure/measure.h).
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// Limit on concurrent requests in this process, for all tokens together, since other requests need
// the two disk threads, too. More get 503.
inline constexpr int kMaxMeasuringAtOnce = 1;
// Twice the size of 64 points with all their digits.
inline constexpr std::size_t kMaxMeasureBodyBytes = 8 * 1024;

// Answers with format_measurement_json().
HttpAnswer measure_scan(const HttpWorld& world, const Call& call);
// 201 with its entry of the list; 409 if there are too many.
HttpAnswer keep_measurement(const HttpWorld& world, const Call& call);
// {"measurements": [...]}, oldest first.
HttpAnswer list_measurements(const HttpWorld& world, const Call& call);
// The same as CSV (RFC 4180).
HttpAnswer send_measurements(const HttpWorld& world, const Call& call);
HttpAnswer remove_measurement(const HttpWorld& world, const Call& call);  // {"removed": id}

}  // namespace hermite::server
