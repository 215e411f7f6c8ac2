// Clouds and meshes of other programs. Input: the file, PLY or GLB.
#include <cstdint>
#include <string_view>

#include "core/base/check.h"
#include "core/import/model.h"
#include "core/output/cloud_check.h"
#include "core/output/mesh_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hermite;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const imports::ImportOptions options;
  const Result<imports::ImportedModel> model = imports::read_model(bytes, options);
  CHECK(model.ok() || !model.error().message.empty(), "an error without words");
  if (!model.ok()) return 0;
  CHECK(model->is_mesh() ? output::check_mesh_with_triangles(model->mesh).ok()
                         : output::check_cloud_with_points(model->cloud).ok(),
        "what was read is no mesh and no cloud");
  CHECK(!imports::remarks_about(*model, options).empty(), "nothing is said of it");
  return 0;
}
