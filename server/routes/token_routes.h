// The routes for tokens and share links. http_routes.h has the table, and server/access/
// administration.h the bodies of requests and answers. On the network thread.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// Lists share links: all of them, or those of one scan. 404: there is no such scan.
HttpAnswer list_all_shares(const HttpWorld& world, const Call& call);
HttpAnswer list_scans_shares(const HttpWorld& world, const Call& call);

// Creates a share link of a scan, with its secret: 201. 400, 404, 409: too many.
HttpAnswer share_scan(const HttpWorld& world, const Call& call);

HttpAnswer list_all_tokens(const HttpWorld& world, const Call& call);

// Creates a token, with its secret: 201. 400, 409: too many.
HttpAnswer make_token(const HttpWorld& world, const Call& call);

// Revoke a share link or a token, from the next request on. 404: there is none of this kind.
HttpAnswer revoke_share(const HttpWorld& world, const Call& call);
HttpAnswer revoke_token(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
