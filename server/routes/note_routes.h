// Notes that people write at places of ended scans. http_routes.h has the table. On the network
// thread, except for reading a body, which a disk thread does.
//
// The body of POST is {"position_m": [x, y, z], "text": ..., "view": {"position_m": [x, y, z],
// "target_m": [x, y, z]}}, in the world frame of the scan; the view, from which it was written, may
// be left out. That of PATCH is {"text": ..., "version": N}, and DELETE has ?version=N: the version
// that the client has read. If the note has another one by now, nothing changes, and the answer is
// a 409 with the note beside the error, so that no text is lost.
//
// A running scan has no notes: a later correction may move its surface by decimetres, and when the
// calibration of its camera turns out to be wrong the scan is made anew, with other submaps. A
// place in it would not stay where somebody has clicked.
#pragma once

#include "server/routes/http_routes.h"

namespace hermite::server {

// The longest text with every byte as an escape of six, and the numbers.
inline constexpr std::size_t kMaxNoteBodyBytes = 16 * 1024;

// Of each coordinate from the origin [m]. More than a viewer goes away from the largest import.
inline constexpr double kFarthestNote_m = 1e6;

HttpAnswer list_notes(const HttpWorld& world, const Call& call);  // {"notes": [...]}, oldest first
// 201 with its entry of the list; 409: running, or too many.
HttpAnswer create_note(const HttpWorld& world, const Call& call);
// Its entry of the list; 409 as above.
HttpAnswer change_note(const HttpWorld& world, const Call& call);
HttpAnswer remove_note(const HttpWorld& world, const Call& call);  // {"removed": id}; 409 as above

}  // namespace hermite::server
