// Measuring in a scan that has ended, over HTTP, and what was measured and kept. http_routes.h has the table. On the network thread, but
// for the reading of surfels, which is done by a thread for the disk while the request waits: a measurement takes about as long as a
// download of surfels.ply would, and holds some megabytes of it at a time.
//
// Body of both POSTs: {"from": [x, y, z], "to": [x, y, z]} in metres in the world of the scan, points on or near surfaces; to keep it also
// "name", 1 to 200 bytes. What is wrong with a point is said in words that name it (core/measure/measure.h), with 400.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

// In this process at once, whoever asks: other requests want the two threads for the disk, too. More are answered with 503.
inline constexpr int kMaxMeasuringAtOnce = 1;

HttpAnswer measure_scan(const HttpWorld& world, const Call& call);        // format_measurement_json
HttpAnswer keep_measurement(const HttpWorld& world, const Call& call);    // 201 with its entry of the list; 409 where there are too many
HttpAnswer list_measurements(const HttpWorld& world, const Call& call);   // {"measurements": [...]}, oldest first
HttpAnswer send_measurements(const HttpWorld& world, const Call& call);   // the same as CSV (RFC 4180)
HttpAnswer remove_measurement(const HttpWorld& world, const Call& call);  // {"removed": id}

}  // namespace hermite
