// Parts of stored files: one range of bytes (RFC 9110, sections 13.1.5 and 14), so that a download that was cut goes on where it was.
// Several ranges at once are answered with the whole, as a server may. Pure functions.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

// `answer` as `request` wants it: 206 with a part of what is stored, 416 where there is nothing of that range, and as it is where none is
// asked for, where the range makes no sense, or where If-Range names another version than `entity_tag`, which is without its quotes. An
// answer without something stored stays as it is.
HttpAnswer as_asked(HttpAnswer answer, const std::string& entity_tag, const HttpRequest& request);

}  // namespace hermite
