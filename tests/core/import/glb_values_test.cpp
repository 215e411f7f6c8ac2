#include "core/import/glb_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/glb_bytes.h"

namespace hermite::imports {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

// A document of one accessor over these bytes.
struct OneAccessor {
  OneAccessor(json accessor, const std::string& binary, json view = json::object()) {
    json all = test::triangle_json();
    view["buffer"] = 0;
    view["byteLength"] = binary.size();
    accessor["bufferView"] = 0;
    all["buffers"][0]["byteLength"] = binary.size();
    all["bufferViews"] = json::array({view});
    all["accessors"] = json::array({accessor});
    bytes = test::glb_of(all.dump(), binary);
  }
  GlbDocument document() const { return *GlbDocument::parse(bytes); }
  std::string bytes;
};

TEST(GlbValues, AreReadWithTheirStrideAndNormalised) {
  const OneAccessor floats({{"componentType", 5126}, {"type", "VEC2"}, {"count", 2}},
                           test::float_bytes({1, 2, 9, 3, 4}), {{"byteStride", 12}});
  const auto values = read_glb_values(floats.document(), 0, 2, 3, 2);
  ASSERT_TRUE(values.ok()) << values.error().message;
  EXPECT_EQ(values->components, 2);
  EXPECT_THAT(values->numbers, ElementsAre(1, 2, 3, 4));
  const OneAccessor bytes(
      {{"componentType", 5121}, {"type", "VEC3"}, {"count", 1}, {"normalized", true}},
      std::string("\xff\0\x33", 3));
  EXPECT_THAT(read_glb_values(bytes.document(), 0, 3, 4, 1)->numbers, ElementsAre(1, 0, 0.2f));
}

TEST(GlbValues, LyingCountsAreErrorsBeforeAnythingIsAllocated) {
  const auto why = [](const json& accessor, std::uint64_t most = 1'000'000'000) {
    const auto values = read_glb_values(
        OneAccessor(accessor, test::float_bytes({1, 2, 3})).document(), 0, 3, 3, most);
    return values.ok() ? "" : values.error().message;
  };
  EXPECT_THAT(why({{"componentType", 5126}, {"type", "VEC3"}, {"count", 900000000}}),
              HasSubstr("900000000 elements in bytes 0 to"));
  EXPECT_THAT(why({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2}}, 1),
              HasSubstr("accessors[0].count is 2, 1 are left"));
  EXPECT_THAT(why({{"componentType", 5126}, {"type", "VEC3"}, {"count", 1}, {"byteOffset", 4}}),
              HasSubstr("bytes 4 to 16"));
  EXPECT_THAT(why({{"componentType", 5124}, {"type", "VEC3"}, {"count", 1}}),
              HasSubstr("componentType"));
  EXPECT_THAT(why({{"componentType", 5126}, {"type", "VEC2"}, {"count", 1}}),
              HasSubstr("has 2 components, 3 belong there"));
  EXPECT_THAT(why({{"componentType", 5126}, {"type", "MAT4"}, {"count", 1}}),
              HasSubstr("SCALAR, VEC2"));
  EXPECT_THAT(
      why({{"componentType", 5126}, {"type", "VEC3"}, {"count", 1}, {"sparse", json::object()}}),
      HasSubstr("is sparse"));
}

TEST(GlbValues, IndicesStayBelowTheirEnd) {
  const OneAccessor bytes({{"componentType", 5121}, {"type", "SCALAR"}, {"count", 3}},
                          std::string("\0\1\2", 3));
  EXPECT_THAT(*read_glb_indices(bytes.document(), 0, 3, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(read_glb_indices(bytes.document(), 0, 2, 3).error().message,
              HasSubstr("index 2 is 2, there are 2 vertices"));
  EXPECT_EQ(*glb_element_count(bytes.document(), 0, 3), 3u);
}

}  // namespace
}  // namespace hermite::imports
