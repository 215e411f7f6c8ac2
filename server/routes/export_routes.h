// What a scan that has ended can be taken away as, over HTTP. http_routes.h has the table. On the network thread.
//
// A share link looks at what its scan has. Of work it may ask for the viewer's mesh alone, without which it has nothing to look at: what a
// stranger with a link can make this machine do is bounded by one mesh.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

// {"exports": [{"format": "glb", "kind": "mesh", "label": "GLB", "file": "mesh.glb", "state": "running", "bytes": 0, "done": 0.4,
// "words": "", "of_format": "glb", "simplify_um": 0, "triangles": 0, "fill_holes_mm": 0, "close": false}, ...]}; `state` is missing,
// queued, running, ready or failed.
HttpAnswer list_exports(const HttpWorld& world, const Call& call);

HttpAnswer create_export(const HttpWorld& world, const Call& call);  // 202 with its entry of the list; 200 when it is ready
HttpAnswer send_export(const HttpWorld& world, const Call& call);    // the file; 404 in words while there is none
HttpAnswer remove_export(const HttpWorld& world, const Call& call);  // {"removed": "glb"}

}  // namespace hermite
