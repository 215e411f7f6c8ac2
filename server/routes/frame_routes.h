// The routes for the frames that the camera of a scan has sent, read from its frame log for people
// who inspect a scan. http_routes.h has the table. On the network thread, except reading and
// decoding, which a disk thread does while the request waits.
//
// Images of a running scan can be read as soon as they are on the disk, and are 204 until then; the
// list only when it has ended.
//
// Errors of all routes: 403 for a share link, which shows the model but not what passed before the
// camera; 404 no such scan or frame, or the scan was imported; 409 the list of a running scan, or
// one that is being restored; 410 its frames were removed; 500 the frame is damaged; 503 too many
// requests at once.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// Limit on concurrent requests in this process, for all tokens together; two are processed at a
// time, the others wait. More get 503.
inline constexpr int kMaxFramesAskedAtOnce = 16;

// Timestamps, and status and reason of each frame, see server/README.md.
HttpAnswer list_scans_frames(const HttpWorld& world, const Call& call);
// JPEG or PNG, as the camera sent it. For a running scan the headers say how far its viewers are
// behind, see server/README.md.
HttpAnswer send_color(const HttpWorld& world, const Call& call);
// Answers with a JPEG for people; ?from_mm=A&to_mm=B is the range of the colour scale.
HttpAnswer send_depth(const HttpWorld& world, const Call& call);
HttpAnswer send_raw_depth(const HttpWorld& world, const Call& call);  // 16-bit PNG in sensor units

}  // namespace hermite::server
