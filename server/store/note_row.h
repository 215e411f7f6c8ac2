// A note that somebody has written at a place of a scan, as a row of the store. Plain values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace hermite::server {

// Limits: of a scan, more than a person would read, and at most a megabyte; of a note, a page of
// text.
inline constexpr int kMaxNotesPerScan = 500;
inline constexpr std::size_t kMaxNoteTextBytes = 2000;

// From where somebody looked. World frame of the scan [m].
struct NoteView {
  std::array<double, 3> position_m = {};  // of the eye
  std::array<double, 3> target_m = {};    // what is in the middle of the image
};

struct NoteRow {
  std::string id;
  std::string scan_id;
  std::array<double, 3> position_m = {};  // on the surface, in the world frame of the scan [m]
  std::optional<NoteView> view;           // from which it was written
  std::string text;                       // UTF-8
  std::int64_t version = 1;               // grows by 1 with each change
  std::int64_t created_at_ms = 0;         // Unix time
  // Unix time of the last change; created_at_ms before the first.
  std::int64_t changed_at_ms = 0;
};

// What has come of the change or removal of a version of a note.
struct NoteOutcome {
  bool is_done = false;  // false: the version was another one, and nothing has changed
  NoteRow note;          // as it is now; if it was removed, as it was
};

}  // namespace hermite::server
