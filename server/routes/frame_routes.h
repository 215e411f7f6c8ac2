// What the camera of a scan has sent, frame by frame, out of its frame log: for people who look back. http_routes.h has the table. On the
// network thread, but for the disk and the decoding: a thread for the disk does these while the request waits.
//
// Answers, whichever is asked for: 403 to a share link, which shows the model and not what has walked past the camera; 404 no such scan or
// frame, or the scan was imported; 409 it runs; 410 its frames were removed; 500 the frame is damaged; 503 too many are asked for.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite {

// In this process at once, whoever asks; two are worked on, the others wait. More are answered with 503.
inline constexpr int kMaxFramesAskedAtOnce = 16;

HttpAnswer list_scans_frames(const HttpWorld& world, const Call& call);  // times and what became of each, see server/README.md
HttpAnswer send_color(const HttpWorld& world, const Call& call);         // JPEG or PNG, as the camera sent it
HttpAnswer send_depth(const HttpWorld& world, const Call& call);         // a JPEG for people; ?from_mm=A&to_mm=B is what the colours span
HttpAnswer send_raw_depth(const HttpWorld& world, const Call& call);     // 16-bit PNG in sensor units

}  // namespace hermite
