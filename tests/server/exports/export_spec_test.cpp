#include "server/exports/export_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/blobs.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(ExportSpec, EveryNameAndFileReadsBackAsWhatItIs) {
  for (const ExportOffer& offer : export_offers())
    for (const MeshShape& shape : {MeshShape{}, MeshShape{1000, 0, 0, false},
                                   MeshShape{10, 50000, 100, true}, MeshShape{0, 0, 0, true}}) {
      if (!shape.is_plain() && (offer.kind != ExportKind::kMesh || offer.is_result)) continue;
      const ExportSpec spec{&offer, shape};
      const Result<ExportSpec> named = export_spec_named(spec.name());
      ASSERT_TRUE(named.ok()) << spec.name();
      EXPECT_EQ(named->offer, &offer);
      EXPECT_EQ(named->shape, shape);
      EXPECT_TRUE(is_blob_name(spec.file())) << spec.file();
      const ExportSpec of_file = shaped_export_of_file(spec.file());
      EXPECT_EQ(of_file.offer, shape.is_plain() ? nullptr : &offer) << spec.file();
      EXPECT_EQ(of_file.shape, shape);
    }
  EXPECT_EQ(export_spec_named("glb-draco_s1000_f100_c")->file(), "mesh_s1000_f100_c.draco.glb");
}

TEST(ExportSpec, WhatIsNotWrittenAsItWouldBeIsNone) {
  for (const char* name :
       {"", "fbx", "glb_", "glb_s", "glb_s01000", "glb_s1000_", "glb_f100_s1000", "glb_c_c",
        "glb_x1", "glb_s-5", "glb_s0", "glb_s99999999999999999999", "glb_s1e3", "_s1000"})
    EXPECT_EQ(export_spec_named(name).error().code, ErrorCode::kNotFound) << name;
  EXPECT_THAT(export_spec_named("fbx").error().message, HasSubstr("known are imported, glb"));
  for (const char* file : {"mesh.glb", "mesh_s1000.ply.tmp", "cloud_s1000.ply", "mesh_s1000",
                           "mesh_.glb", "report.json", "imported_c.glb"})
    EXPECT_EQ(shaped_export_of_file(file).offer, nullptr) << file;
}

TEST(ExportSpec, LimitsAreNamed) {
  EXPECT_THAT(export_spec_named("glb_s9").error().message,
              HasSubstr("simplify_um is 9: expected 0, or 10 to 100000"));
  EXPECT_THAT(export_spec_named("glb_t5").error().message, HasSubstr("needs simplify_um"));
  EXPECT_THAT(export_spec_named("glb_f10001").error().message, HasSubstr("fill_holes_mm is 10001"));
  EXPECT_THAT(export_spec_named("las_c").error().message, HasSubstr("las is no mesh"));
  EXPECT_THAT(export_spec_named("imported_c").error().message,
              HasSubstr("imported is kept as it came"));
  const ExportOffer& glb = *find_export_offer("glb");
  EXPECT_THAT(check_shape(glb, {1000, -1, 0, false}).error().message, HasSubstr("triangles is -1"));
  EXPECT_THAT(check_shape(glb, {-1, 0, 0, false}).error().message, HasSubstr("simplify_um is -1"));
}

}  // namespace
}  // namespace hermite::server
