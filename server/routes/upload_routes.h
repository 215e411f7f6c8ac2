// Uploads over HTTP: tus 1.0.0 (https://tus.io/protocols/resumable-upload) and a plain PUT.
// http_routes.h has the table. A complete recording becomes a job with the id of its upload. On the
// network thread.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

inline constexpr int kChecksumMismatch = 460;  // status code defined by tus

HttpAnswer list_uploads(const HttpWorld& world, const Call& call);      // {"uploads": [...]}
HttpAnswer describe_uploads(const HttpWorld& world, const Call& call);  // supported parts of tus
HttpAnswer create_upload(const HttpWorld& world, const Call& call);     // 201
HttpAnswer show_upload(const HttpWorld& world, const Call& call);       // for HEAD
HttpAnswer continue_upload(const HttpWorld& world, const Call& call);   // 204
HttpAnswer remove_upload(const HttpWorld& world, const Call& call);     // 204
HttpAnswer put_upload(const HttpWorld& world, const Call& call);        // 201 {"job": id}

}  // namespace hermite::server
