#include "server/ply_file.h"

#include <utility>

#include "core/dataset/text_file.h"

namespace hermite {

PlyShape read_ply_file(const std::string& path) {
  Result<PlyShape> shape = parse_ply(or_throw(read_text_file(path, kMaxPly_bytes)));
  if (!shape.ok()) throw SetupError(in_context(path, shape.error()));
  return *std::move(shape);
}

}  // namespace hermite
