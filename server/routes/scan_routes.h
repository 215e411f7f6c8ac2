// The routes by which a person looks after scans: what they may do, another title, and the end of a scan that runs. On the network thread.
#pragma once

#include <optional>
#include <string>

#include "server/routes/http_routes.h"

namespace hermite {

// {"scopes": ["view", ...], "scan": id or null}: what whoever asks may do, so that a page need not offer what would be refused.
HttpAnswer show_access(const HttpWorld& world, const Call& call);

// {"scans": [...], "more"}: the newest first, for a share link its scan alone. ?older-than=ID goes on behind one. 400 for another query.
HttpAnswer list_scans(const HttpWorld& world, const Call& call);

// One entry of that list. 404.
HttpAnswer show_scan(const HttpWorld& world, const Call& call);

// {"removed": id}: deleted with its files. 404, 409: it runs.
HttpAnswer remove_scan(const HttpWorld& world, const Call& call);

// {"title": ...}: of the token that made the scan, or admin. The scan as it is then. 400 naming the field, 403, 404.
HttpAnswer rename_scan(const HttpWorld& world, const Call& call);

// None: whoever asks may change the scan, as the token that made it or with admin. Else the answer: 403, 404.
std::optional<HttpAnswer> keep_out(const HttpWorld& world, const Call& call);

// Whether `text`, which came as `field`, can be shown as a title: 1 to wire::kMaxTitleBytes without control characters. kInvalidArgument.
Status check_title(const std::string& field, const std::string& text);

// A scan that runs ends as interrupted, with what it has; of the token that made it, or admin. 403, 404, 409: it has ended, or a job feeds
// it.
HttpAnswer stop_scan(const HttpWorld& world, const Call& call);

}  // namespace hermite
