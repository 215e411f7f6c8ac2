// The edits of a scan (core/edit/scan_edits.h): what its owner has taken out of it. http_routes.h
// has the table. On the network thread, except for reading a body, which a disk thread does.
//
// GET answers {"version": N, "edits": [...]}; version 0 was never edited. PUT has the same: the
// version that the client has read, and the new list. If the scan has another version by now,
// nothing changes, and the answer is a 409 with the edits as they are beside the error, unless they
// are those that were sent: a request may be repeated.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

HttpAnswer show_edits(const HttpWorld& world, const Call& call);
// The edits with their new version; 409 also: the scan is running.
HttpAnswer change_edits(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
