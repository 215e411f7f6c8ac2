// The routes of jobs (http_routes.h has the table). On the network thread.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

HttpAnswer list_jobs(const HttpWorld& world, const Call& call);
HttpAnswer show_job(const HttpWorld& world, const Call& call);
HttpAnswer create_job(const HttpWorld& world, const Call& call);  // 201
HttpAnswer cancel_job(const HttpWorld& world, const Call& call);
HttpAnswer retry_job(const HttpWorld& world, const Call& call);

}  // namespace hermite::server
