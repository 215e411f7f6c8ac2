// The scene of a GLB as one mesh, or as points where it has no triangles. Pure.
#pragma once

#include <string_view>

#include "core/import/model.h"

namespace hermite {

// As read_model, without what that looks at for all formats: numbers may be none, and the extent any.
Result<ImportedModel> read_glb_model(std::string_view bytes, const ImportOptions& options);

}  // namespace hermite
