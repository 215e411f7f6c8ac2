// Measuring in a scan that has ended, over HTTP, and what was measured and kept. http_routes.h has the table. On the network thread, but
// for the reading of surfels, which is done by a thread for the disk while the request waits: the first measurement in a scan takes about
// as long as a download of surfels.ply would, the next ones some milliseconds (measuring_cache.h).
//
// Body of both POSTs: {"kind": ..., "points": [[x, y, z], ...]} (core/measure/quantity.h has the kinds), in metres in the world of the
// scan, points on or near surfaces; of a height also "up", a unit vector; to keep it also "name", 1 to 200 bytes. What is wrong with a
// point is said in words that name it (core/measure/measure.h), with 400.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

// In this process at once, whoever asks: other requests want the two threads for the disk, too. More are answered with 503.
inline constexpr int kMaxMeasuringAtOnce = 1;
// 64 corners of numbers with all their digits are half of it.
inline constexpr std::size_t kMaxMeasureBodyBytes = 8 * 1024;

HttpAnswer measure_scan(const HttpWorld& world, const Call& call);        // format_measurement_json
HttpAnswer keep_measurement(const HttpWorld& world, const Call& call);    // 201 with its entry of the list; 409 where there are too many
HttpAnswer list_measurements(const HttpWorld& world, const Call& call);   // {"measurements": [...]}, oldest first
HttpAnswer send_measurements(const HttpWorld& world, const Call& call);   // the same as CSV (RFC 4180)
HttpAnswer remove_measurement(const HttpWorld& world, const Call& call);  // {"removed": id}

}  // namespace hermite
