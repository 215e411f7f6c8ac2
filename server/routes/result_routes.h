// The routes for the files that an ended scan consists of. http_routes.h has the table. On the
// network thread, except reading, which a disk thread does.
#pragma once

#include <string>

#include "server/routes/http_routes.h"

namespace hermite::server {

// Sends a file of an ended scan, or the requested part of it. 404: the scan is not there, or
// still runs.
HttpAnswer send_file(const HttpWorld& world, const Call& call, const std::string& name,
                     const char* content_type);

// Send one of the files. 404: the scan is not there, or still runs.
HttpAnswer send_cloud(const HttpWorld& world, const Call& call);
HttpAnswer send_trajectory(const HttpWorld& world, const Call& call);
HttpAnswer send_report(const HttpWorld& world, const Call& call);

// Sends a small image of the scan, JPEG; 204 if it has none, or none yet. 404: there is no such
// scan.
HttpAnswer send_thumbnail(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
