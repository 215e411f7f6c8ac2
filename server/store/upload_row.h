// An upload as a row of the store; its bytes are a file (data_directory.h), whose length is how much of it there is. Plain values.
#pragma once

#include <cstdint>
#include <string>

namespace hermite {

struct UploadRow {
  std::string id;
  std::string token_id;              // who sends it
  std::int64_t length_bytes = -1;    // in the end; -1: not known yet
  std::string metadata;              // as it came (tus.h)
  std::int64_t unchecked_from = -1;  // from this byte on the file has a piece whose checksum has not been checked; -1: there is none
  std::int64_t created_at_ms = 0;    // Unix time
  std::int64_t expires_at_ms = 0;    // when it is removed, unless something happens with it before
};

}  // namespace hermite
