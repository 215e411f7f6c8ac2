#include "core/import/glb_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/glb_bytes.h"

namespace hermite::imports {
namespace {

using nlohmann::json;
using test::glb_of;
using test::triangle_binary;
using test::triangle_json;
using testing::HasSubstr;

std::string why_no_document(const std::string& bytes) {
  const auto document = GlbDocument::parse(bytes);
  return document.ok() ? "" : document.error().message;
}

std::string changed(const std::string& pointer, const json& value) {
  json all = triangle_json();
  all[json::json_pointer(pointer)] = value;
  return glb_of(all.dump(), triangle_binary());
}

TEST(GlbDocument, HasTheRangesThatItNames) {
  const std::string bytes = glb_of(triangle_json().dump(), triangle_binary());
  const auto document = GlbDocument::parse(bytes);
  ASSERT_TRUE(document.ok()) << document.error().message;
  EXPECT_EQ(document->count("accessors"), 2u);
  EXPECT_EQ(*document->view(1), std::string_view("\0\0\1\0\2\0", 6));
  EXPECT_THAT(document->view(2).error().message, HasSubstr("no bufferViews[2], there are 2"));
}

TEST(GlbDocument, EveryCutIsAnErrorWithAMessage) {
  const std::string bytes = glb_of(triangle_json().dump(), triangle_binary());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THAT(why_no_document(bytes.substr(0, length)), HasSubstr("GLB"));
}

TEST(GlbDocument, WhatIsWrongIsNamed) {
  EXPECT_THAT(why_no_document("solid thing\nfacet normal"),
              HasSubstr("does not start with 'glTF'"));
  EXPECT_THAT(why_no_document(changed("/buffers/0/uri", "https://example.org/a.bin")),
              HasSubstr("buffers[0] has a uri"));
  EXPECT_THAT(why_no_document(changed("/images", {{{"uri", "file:///etc/passwd"}}})),
              HasSubstr("images[0] has a uri"));
  EXPECT_THAT(why_no_document(changed("/extensionsRequired", {"EXT_meshopt_compression"})),
              HasSubstr("'EXT_meshopt_compression'; known are"));
  EXPECT_EQ(why_no_document(changed("/extensionsRequired",
                                    {"KHR_materials_unlit", "KHR_draco_mesh_compression"})),
            "");
  EXPECT_THAT(why_no_document(changed("/buffers/0/byteLength", 1000000)),
              HasSubstr("byteLength is 1000000, the binary chunk has 44"));
  EXPECT_THAT(why_no_document(changed("/nodes", "many")), HasSubstr("nodes is not an array"));
  EXPECT_THAT(why_no_document(changed("/nodes/0", 7)), HasSubstr("nodes[0] is not an object"));
  const std::string deep(1000, '[');
  EXPECT_THAT(why_no_document(glb_of("{\"a\":" + deep, "")), HasSubstr("nested deeper than"));
  std::string version = glb_of(triangle_json().dump(), triangle_binary());
  version[4] = 1;
  EXPECT_THAT(why_no_document(version), HasSubstr("version 1, known is 2"));
}

TEST(GlbDocument, RangesBeyondTheFileAreNotGiven) {
  const std::string bytes = changed("/bufferViews/0/byteOffset", 4294967295u);
  const auto document = GlbDocument::parse(bytes);
  ASSERT_TRUE(document.ok());
  EXPECT_THAT(document->view(0).error().message,
              HasSubstr("bufferViews[0] has bytes 4294967295 to"));
}

TEST(GlbDocument, NumbersAreWhatTheySay) {
  const json object = {{"a", 3.0}, {"b", -1}, {"c", 1e300}, {"d", {1, 2}}, {"e", {1, nullptr}}};
  EXPECT_EQ(**glb_index(object, "a", "x"), 3u);
  EXPECT_FALSE(glb_index(object, "z", "x")->has_value());
  EXPECT_EQ(glb_index(object, "b", "x").error().message, "GLB: x.b is not a whole number");
  EXPECT_FALSE(glb_index(object, "c", "x").ok());
  EXPECT_THAT(glb_index(object, "a", "x", 2).error().message, HasSubstr("is 3, the limit is 2"));
  EXPECT_EQ((**glb_numbers(object, "d", 2, "x"))[1], 2);
  EXPECT_FALSE(glb_numbers(object, "d", 3, "x").ok());
  EXPECT_FALSE(glb_numbers(object, "e", 2, "x").ok());
  EXPECT_EQ(glb_member(object, "a"), nullptr);
}

}  // namespace
}  // namespace hermite::imports
