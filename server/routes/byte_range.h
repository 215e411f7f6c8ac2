// Serves parts of stored files as single byte ranges (RFC 9110, sections 13.1.5 and 14), so that an
// interrupted download can be resumed. A request for several ranges gets the whole file, which the
// RFC allows. Pure functions.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// Returns `answer` as requested: 206 with part of the stored body; 416 if the range lies beyond it;
// unchanged if there is no range, it is malformed, or If-Range names another version than
// `entity_tag` (given without quotes). An answer without a stored body is returned unchanged.
HttpAnswer as_asked(HttpAnswer answer, const std::string& entity_tag, const HttpRequest& request);

}  // namespace hermite::server
