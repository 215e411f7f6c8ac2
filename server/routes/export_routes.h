// The routes for exports of ended scans. http_routes.h has the table. On the network thread.
//
// A share link can download existing exports. The only one that it can request is the viewer's
// mesh, without which there would be nothing to view: so a stranger with a link can cause at most
// the work of one mesh.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// {"exports": [{"format": "glb", "kind": "mesh", "label": "GLB", "file": "mesh.glb", "state":
// "running", "bytes": 0, "done": 0.4, "words": "", "of_format": "glb", "simplify_um": 0,
// "triangles": 0, "fill_holes_mm": 0, "close": false},
// ...]}; `state` is missing, queued, running, ready or failed.
HttpAnswer list_exports(const HttpWorld& world, const Call& call);

// 202 with its entry of the list; 200 if it is ready.
HttpAnswer create_export(const HttpWorld& world, const Call& call);
// The file; 404, with a message, if there is none.
HttpAnswer send_export(const HttpWorld& world, const Call& call);
HttpAnswer remove_export(const HttpWorld& world, const Call& call);  // {"removed": "glb"}

}  // namespace hermite::server
