#include "server/ply_file.h"

#include <utility>

#include "core/dataset/text_file.h"

namespace hermite::commands {

output::PlyShape read_ply_file(const std::string& path) {
  Result<output::PlyShape> shape =
      output::parse_ply(or_throw(dataset::read_text_file(path, kMaxPly_bytes)));
  if (!shape.ok()) throw SetupError(in_context(path, shape.error()));
  return *std::move(shape);
}

}  // namespace hermite::commands
