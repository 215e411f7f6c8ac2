// The routes to manage scans: permissions, list, title, deletion, and the end of a running scan. On
// the network thread.
#pragma once

#include <optional>
#include <string>

#include "server/routes/http_routes.h"

namespace hermite::server {

// {"scopes": ["view", ...], "scan": id or null}: the permissions of the token, so that a page need
// not offer what would be refused.
HttpAnswer show_access(const HttpWorld& world, const Call& call);

// {"scans": [...], "more"}: newest first, for a share link only its scan. ?older-than=ID continues
// after that scan. 400 for any other query.
HttpAnswer list_scans(const HttpWorld& world, const Call& call);

// An entry of that list. 404.
HttpAnswer show_scan(const HttpWorld& world, const Call& call);

// {"removed": id}: deletes it with its files. 404, 409: it is running.
HttpAnswer remove_scan(const HttpWorld& world, const Call& call);

// {"title": ..., "tags": [...]}, one of them or both: for the token that made the scan, or admin.
// Answers with the scan as it is now. 400 naming the field, 403, 404.
HttpAnswer label_scan(const HttpWorld& world, const Call& call);

// Returns std::nullopt if the caller may change the scan, as the token that made it or with admin;
// otherwise the answer: 403, 404.
std::optional<HttpAnswer> keep_out(const HttpWorld& world, const Call& call);

// Checks whether `text`, given as `field`, is valid as a title: 1 to wire::kMaxTitleBytes without
// control characters. kInvalidArgument.
Status check_title(const std::string& field, const std::string& text);

// Ends a running scan as interrupted, with what it has; for the token that made it, or admin. 403,
// 404, 409: it has ended, or belongs to a job.
HttpAnswer stop_scan(const HttpWorld& world, const Call& call);

// Ask the camera of a running scan to pause, or to go on, which it then says over its connection;
// for the same. 403, 404, 409: the scan does not run, or its camera is away or cannot be asked.
HttpAnswer pause_scan(const HttpWorld& world, const Call& call);
HttpAnswer unpause_scan(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
