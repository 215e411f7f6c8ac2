// Notes in a folder of data that something of it is elsewhere: two lines, the address of that place
// and the id that this place has of the folder. They survive a power failure.
#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

struct PlaceNote {
  std::string address, id;
};

// Returns std::nullopt if there is no such file. kCorruptData: it is no note. kIo.
Result<std::optional<PlaceNote>> read_place_note(const std::string& path);

Status write_place_note(const std::string& path, const PlaceNote& note);  // kIo

// Give a file of the folder another name, or remove it; succeed if there is none. kIo.
Status rename_in_folder(const std::string& folder, const std::string& from, const std::string& to);
Status remove_in_folder(const std::string& folder, const std::string& name);

}  // namespace hermite::server
