// Uploads over HTTP: tus 1.0.0 (https://tus.io/protocols/resumable-upload) and a plain PUT. http_routes.h has the table. A recording that
// is whole becomes a job with the id of its upload. On the network thread.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

inline constexpr int kChecksumMismatch = 460;  // tus's own

HttpAnswer list_uploads(const HttpWorld& world, const Call& call);      // {"uploads": [...]}
HttpAnswer describe_uploads(const HttpWorld& world, const Call& call);  // what of tus there is
HttpAnswer create_upload(const HttpWorld& world, const Call& call);     // 201
HttpAnswer show_upload(const HttpWorld& world, const Call& call);       // of a HEAD
HttpAnswer continue_upload(const HttpWorld& world, const Call& call);   // 204
HttpAnswer remove_upload(const HttpWorld& world, const Call& call);     // 204
HttpAnswer put_upload(const HttpWorld& world, const Call& call);        // 201 {"job": id}

}  // namespace hermite
