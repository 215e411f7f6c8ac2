#include "core/edit/scan_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hermite::edit {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

Json box_json() {
  return {{"axes", {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}},
          {"low_m", {-1, -2, -3}},
          {"high_m", {1, 2, 3.5}}};
}
Json list_json(const Json& edit) { return {{"version", 3}, {"edits", Json::array({edit})}}; }
Json crop_json() { return {{"kind", "keep_inside"}, {"box", box_json()}}; }

std::string refusal_of(const Json& list) {
  const Result<ScanEdits> edits = parse_scan_edits(list.dump());
  if (edits.ok()) return "";
  EXPECT_EQ(edits.error().code, ErrorCode::kInvalidArgument);
  return edits.error().message;
}

TEST(ScanEdits, AreReadAsTheyWereWritten) {
  ScanEdits edits{7, {}};
  EditBox box;
  box.axes << 0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1;
  box.low_m = {-0.1, 1.0 / 3, 2};
  box.high_m = {0.1, 1, 3};
  edits.edits = {{EditKind::kKeepInside, box, 0},
                 {EditKind::kRemoveInside, box, 0},
                 {EditKind::kRemoveFloating, {}, 0.3}};
  const Result<ScanEdits> read = parse_scan_edits(format_scan_edits(edits));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(*read, edits);
}

TEST(ScanEdits, ABoxHoldsWhatIsBetweenItsFaces) {
  const EditBox box = parse_scan_edits(list_json(crop_json()).dump())->edits.front().box;
  EXPECT_TRUE(box.holds({0, 0, 0}));
  EXPECT_TRUE(box.holds({0.6, 0.8, 3.5}));
  EXPECT_FALSE(box.holds({0.61, 0.81, 0}));
  EXPECT_TRUE(box.holds({-1.5, 1.1, 0})) << "along the second direction";
  EXPECT_FALSE(box.holds({0, 0, 3.6}));
}

TEST(ScanEdits, WhatIsWrongIsNamed) {
  EXPECT_THAT(refusal_of(Json::array()), HasSubstr("\"version\" and the list \"edits\""));
  EXPECT_THAT(refusal_of({{"version", -1}, {"edits", Json::array()}}),
              HasSubstr("version must be"));
  EXPECT_THAT(refusal_of({{"version", 1}, {"edits", Json::array()}, {"more", 1}}),
              HasSubstr("nothing else"));
  Json many = list_json(crop_json());
  while (many["edits"].size() <= kMostEdits) many["edits"].push_back(crop_json());
  EXPECT_THAT(refusal_of(many), HasSubstr("has 17 entries, at most 16"));
  EXPECT_THAT(refusal_of(list_json({{"kind", "explode"}, {"box", box_json()}})),
              HasSubstr("edits[0].kind must be"));
  EXPECT_THAT(refusal_of(list_json({{"kind", "keep_inside"}})), HasSubstr("edits[0] must have"));
  EXPECT_THAT(refusal_of(list_json({{"kind", "remove_floating"}, {"smaller_than_m", 11}})),
              HasSubstr("0.01 to 10"));
  EXPECT_THAT(refusal_of(list_json({{"kind", "remove_floating"}, {"smaller_than_m", "1"}})),
              HasSubstr("must be a number"));
  const auto with = [](const char* field, const Json& value) {
    Json edit = crop_json();
    edit["box"][field] = value;
    return list_json(edit);
  };
  EXPECT_THAT(refusal_of(with("axes", {{1, 0, 0}, {0, 1, 0}})),
              HasSubstr("edits[0].box.axes must be three directions"));
  EXPECT_THAT(refusal_of(with("axes", {{1, 0, 0}, {0.1, 1, 0}, {0, 0, 1}})),
              HasSubstr("at right angles"));
  EXPECT_THAT(refusal_of(with("axes", {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}})),
              HasSubstr("at right angles"));
  EXPECT_THAT(refusal_of(with("low_m", {-1, "x", 1})),
              HasSubstr("edits[0].box.low_m must be three numbers"));
  EXPECT_THAT(refusal_of(with("high_m", {1, 2, 1001})),
              HasSubstr("edits[0].box.high_m[2] is 1001, allowed are -1000 to 1000"));
  EXPECT_THAT(refusal_of(with("high_m", {1, -2, 3})), HasSubstr("above low_m"));
  EXPECT_THAT(parse_scan_edits("{").error().message, HasSubstr("must be a JSON object"));
}

}  // namespace
}  // namespace hermite::edit
