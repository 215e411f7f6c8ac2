// Reads the scene of a GLB as one mesh, or as points if it has no triangles. Pure.
#pragma once

#include <string_view>

#include "core/import/model.h"

namespace hermite::imports {

// Like read_model, without its checks that apply to all formats: values may be not finite, and the
// extent is not limited.
Result<ImportedModel> read_glb_model(std::string_view bytes, const ImportOptions& options);

}  // namespace hermite::imports
