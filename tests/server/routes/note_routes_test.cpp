// Notes over HTTP, of a real server.
#include "server/routes/note_routes.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/store/note_row.h"
#include "server/store/scan_id.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace note_routes_test {

using Json = nlohmann::json;
using testing::HasSubstr;

class NoteRoutesTest : public test::RouteTest {
 protected:
  NoteRoutesTest() {
    add_scans({test::finished_row(id_), test::finished_row(other_id_)});
    start();
  }
  using Answer = test::RouteAnswer;
  Answer ask(const std::string& method, const std::string& path, const std::string& body = "",
             const std::string& token = "") {
    return RouteTest::ask(method, "/api/v1/" + path, token.empty() ? server_->token() : token,
                          body);
  }
  Answer write(const std::string& body, const std::string& token = "") {
    return ask("POST", notes_, body, token);
  }
  // Behind the back of the server.
  void in_database(const std::string& statement) {
    SQLite::Database database(folder_ / "data/hermite.db", SQLite::OPEN_READWRITE);
    database.exec(statement);
  }
  Json list() { return ask("GET", notes_).json()["notes"]; }

  const std::string id_ = new_scan_id(), other_id_ = new_scan_id(),
                    notes_ = "scans/" + id_ + "/notes";
};

const std::string kPlace = R"("position_m": [0.5, -1e-3, 2])";
const std::string kNote = "{" + kPlace + R"(, "text": "a crack"})";

TEST_F(NoteRoutesTest, ANoteIsWrittenChangedAndRemoved) {
  EXPECT_EQ(list(), Json::array());
  const Answer written = write("{" + kPlace +
                               R"(, "text": "a crack\n\u00fcber \ud83e\uddf1", )"
                               R"("view": {"position_m": [0, 0, 0], "target_m": [0, 0, 1.5]}})");
  ASSERT_EQ(written.status, 201) << written.body;
  const Json note = written.json();
  EXPECT_EQ(note["position_m"], Json({0.5, -1e-3, 2.0}));
  EXPECT_EQ(note["view"],
            Json::parse(R"({"position_m": [0.0, 0.0, 0.0], "target_m": [0.0, 0.0, 1.5]})"));
  EXPECT_EQ(note["text"], "a crack\nüber 🧱");
  EXPECT_EQ(note["version"], 1);
  EXPECT_EQ(note["created_at"], note["changed_at"]);
  // Notes of the same millisecond are listed by their ids, which are random.
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Json second = write(kNote).json();
  EXPECT_EQ(second["view"], nullptr);
  EXPECT_EQ(list(), Json({note, second})) << "oldest first";

  const std::string one = notes_ + "/" + note["id"].get<std::string>();
  const Answer changed = ask("PATCH", one, R"({"text": "repaired", "version": 1})");
  ASSERT_EQ(changed.status, 200) << changed.body;
  EXPECT_EQ(changed.json()["text"], "repaired");
  EXPECT_EQ(changed.json()["version"], 2);
  EXPECT_EQ(changed.json()["created_at"], note["created_at"]);
  EXPECT_EQ(list()[0], changed.json());
  EXPECT_EQ(ask("DELETE", one + "?version=2").status, 200);
  EXPECT_EQ(ask("DELETE", one + "?version=2").status, 404);
  EXPECT_EQ(ask("PATCH", one, R"({"text": "again", "version": 2})").status, 404);
  EXPECT_EQ(list(), Json::array({second}));
}

TEST_F(NoteRoutesTest, NobodysTextIsLostWhenTwoChangeIt) {
  const std::string one = notes_ + "/" + write(kNote).json()["id"].get<std::string>();
  ASSERT_EQ(ask("PATCH", one, R"({"text": "of Ada", "version": 1})").status, 200);
  for (const Answer& late : {ask("PATCH", one, R"({"text": "of Ben", "version": 1})"),
                             ask("DELETE", one + "?version=1")}) {
    EXPECT_EQ(late.status, 409);
    EXPECT_THAT(late.message(), HasSubstr("the note has version 2 by now"));
    EXPECT_EQ(late.json()["note"], list()[0]);
    EXPECT_EQ(late.json()["note"]["text"], "of Ada");
  }
  ASSERT_EQ(ask("PATCH", one, R"({"text": "of Ada and Ben", "version": 2})").status, 200);
  EXPECT_EQ(list()[0]["text"], "of Ada and Ben");
}

TEST_F(NoteRoutesTest, WhatIsNoNoteIsSaidInAMessage) {
  const auto message_of = [&](const std::string& body) {
    const Answer answer = write(body);
    EXPECT_EQ(answer.status, 400) << body;
    return answer.message();
  };
  const std::string text = R"(, "text": "a"})";
  EXPECT_THAT(message_of("nonsense"), HasSubstr("JSON object"));
  EXPECT_THAT(message_of("[]"), HasSubstr("JSON object"));
  EXPECT_THAT(message_of("{" + kPlace + ", \"text\": \"\xff\"}"), HasSubstr("JSON object"))
      << "no UTF-8";
  EXPECT_THAT(message_of("{" + kPlace + R"(, "text": "\ud800"})"), HasSubstr("JSON object"))
      << "half a character";
  EXPECT_THAT(message_of(R"({"text": "a"})"), HasSubstr("position_m must be three numbers"));
  EXPECT_THAT(message_of(R"({"position_m": [1, 2])" + text),
              HasSubstr("position_m must be three numbers"));
  EXPECT_THAT(message_of(R"({"position_m": [1, 2, null])" + text),
              HasSubstr("position_m must be three numbers"));
  EXPECT_THAT(message_of(R"({"position_m": [1, NaN, 2])" + text), HasSubstr("JSON object"));
  EXPECT_THAT(message_of(R"({"position_m": [1, 1e999, 2])" + text), HasSubstr("JSON object"));
  EXPECT_THAT(message_of(R"({"position_m": [1, 2, -1e7])" + text),
              HasSubstr("position_m[2] is -1e+07, allowed are -1000000 to 1000000"));
  EXPECT_THAT(message_of("{" + kPlace + "}"), HasSubstr("text is missing"));
  EXPECT_THAT(message_of("{" + kPlace + R"(, "text": 7})"),
              HasSubstr("text is missing, or no text"));
  EXPECT_THAT(message_of("{" + kPlace + R"(, "text": ""})"),
              HasSubstr("text has 0 bytes, allowed are 1 to 2000"));
  EXPECT_THAT(message_of("{" + kPlace + R"(, "text": ")" + std::string(2001, 'a') + "\"}"),
              HasSubstr("text has 2001 bytes"));
  for (const char* control : {"\\t", "\\r", "\\u0000", "\\u001b", "\\u007f", "\\u0085"})
    EXPECT_THAT(message_of("{" + kPlace + R"(, "text": "a)" + control + "\"}"),
                HasSubstr("text has a control character"))
        << control;
  EXPECT_THAT(message_of("{" + kPlace + R"(, "author": "a")" + text), HasSubstr("nothing else"));
  EXPECT_THAT(message_of("{" + kPlace + R"(, "view": 1)" + text), HasSubstr("view must have"));
  EXPECT_THAT(message_of("{" + kPlace + R"(, "view": {"position_m": [0, 0, 0]})" + text),
              HasSubstr("view must have"));
  EXPECT_THAT(message_of("{" + kPlace +
                         R"(, "view": {"position_m": [0, 0, 0], "target_m": [0, 0]})" + text),
              HasSubstr("view.target_m must be"));
  EXPECT_THAT(message_of("{" + kPlace +
                         R"(, "view": {"position_m": [0, 1e8, 0], "target_m": [0, 0, 0]})" + text),
              HasSubstr("view.position_m[1] is"));
  EXPECT_THAT(message_of("{" + kPlace +
                         R"(, "view": {"position_m": [0, 0, 1], "target_m": [0, 0, 1]})" + text),
              HasSubstr("the same place"));
  EXPECT_EQ(write("").status, 400);
  const Answer long_body = write(std::string(kMaxNoteBodyBytes + 1, ' '));
  EXPECT_EQ(long_body.status, 413);
  EXPECT_THAT(long_body.message(), HasSubstr("allowed are 1 to 16384"));
  EXPECT_EQ(list(), Json::array());
}

TEST_F(NoteRoutesTest, AChangeNamesItsVersion) {
  const std::string one = notes_ + "/" + write(kNote).json()["id"].get<std::string>();
  for (const char* body :
       {"nonsense", R"({"text": "b"})", R"({"text": "b", "version": 1, "view": null})"})
    EXPECT_THAT(ask("PATCH", one, body).message(),
                HasSubstr("JSON object with \"text\" and \"version\""))
        << body;
  for (const char* version : {"0", "-1", "1.5", "\"1\"", "null", "18446744073709551615"})
    EXPECT_THAT(
        ask("PATCH", one, std::string(R"({"text": "b", "version": )") + version + "}").message(),
        HasSubstr("a whole number from 1"))
        << version;
  EXPECT_THAT(ask("PATCH", one, R"({"text": "", "version": 1})").message(),
              HasSubstr("text has 0 bytes"));
  for (const char* query : {"", "?version=", "?version=0", "?version=1x",
                            "?version=99999999999999999999", "?v=1", "?version=1&version=1"})
    EXPECT_THAT(ask("DELETE", one + query).message(), HasSubstr("?version= must be")) << query;
  EXPECT_EQ(ask("PATCH", one, R"({"text": "b", "version": 9223372036854775807})").status, 409);
  EXPECT_EQ(list()[0]["text"], "a crack");
}

TEST_F(NoteRoutesTest, TheLongestTextHasRoomHoweverItIsWritten) {
  std::string emoji, escaped;
  for (int i = 0; i < 500; ++i) emoji += "\xF0\x9F\xA7\xB1";
  for (std::size_t i = 0; i < kMaxNoteTextBytes; ++i) escaped += "\\u0061";
  EXPECT_EQ(write("{" + kPlace + R"(, "text": ")" + emoji + "\"}").json()["text"], emoji);
  EXPECT_EQ(write("{" + kPlace + R"(, "text": ")" + escaped + "\"}").json()["text"],
            std::string(kMaxNoteTextBytes, 'a'));
}

TEST_F(NoteRoutesTest, AScanHasOnlySoManyNotes) {
  in_database(
      "WITH RECURSIVE number(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM number WHERE n < " +
      std::to_string(kMaxNotesPerScan - 1) + ") INSERT INTO notes SELECT 'note ' || n, '" + id_ +
      "', 1, 2, 3, NULL, NULL, NULL, NULL, NULL, NULL, 'text', 1, n, n FROM number");
  ASSERT_EQ(write(kNote).status, 201);
  const Answer answer = write(kNote);
  EXPECT_EQ(answer.status, 409);
  EXPECT_THAT(answer.message(), HasSubstr("at most 500 notes"));
  EXPECT_EQ(list().size(), 500u);
}

TEST_F(NoteRoutesTest, OthersReadAndWriteNothing) {
  const std::string one = notes_ + "/" + write(kNote).json()["id"].get<std::string>();
  const Json share = ask("POST", "scans/" + id_ + "/shares").json();
  for (const std::string& token :
       {share["secret"].get<std::string>(), make_token(R"(["view", "scan"])")}) {
    EXPECT_EQ(ask("GET", notes_, "", token).json()["notes"].size(), 1u);
    EXPECT_EQ(write(kNote, token).status, 403) << "the scan is of another token";
    EXPECT_EQ(ask("PATCH", one, R"({"text": "b", "version": 1})", token).status, 403);
    EXPECT_EQ(ask("DELETE", one + "?version=1", "", token).status, 403);
  }
  const std::string other = "scans/" + other_id_ + "/notes";
  EXPECT_EQ(ask("GET", other, "", share["secret"]).status, 404);
  const std::string elsewhere = other + one.substr(notes_.size());
  EXPECT_EQ(ask("PATCH", elsewhere, R"({"text": "b", "version": 1})").status, 404)
      << "it is not a note of that scan";
  EXPECT_EQ(ask("DELETE", elsewhere + "?version=1").status, 404);
  EXPECT_EQ(ask("DELETE", "shares/" + share["share"]["id"].get<std::string>()).status, 200);
  EXPECT_EQ(ask("GET", notes_, "", share["secret"]).status, 401);
  EXPECT_EQ(list().size(), 1u);
}

TEST_F(NoteRoutesTest, ARunningScanHasNone) {
  in_database("UPDATE scans SET phase = 'running' WHERE id = '" + id_ + "'");
  const Answer answer = write(kNote);
  EXPECT_EQ(answer.status, 409);
  EXPECT_THAT(answer.message(), HasSubstr("its surface may still move"));
  EXPECT_EQ(list(), Json::array());
}

TEST_F(NoteRoutesTest, NotesGoWithTheirScan) {
  const std::string one = notes_ + "/" + write(kNote).json()["id"].get<std::string>();
  ASSERT_EQ(ask("DELETE", "scans/" + id_).status, 200);
  EXPECT_EQ(ask("GET", notes_).status, 404);
  EXPECT_EQ(write(kNote).status, 404);
  EXPECT_EQ(ask("PATCH", one, R"({"text": "b", "version": 1})").status, 404);
  EXPECT_EQ(ask("DELETE", one + "?version=1").status, 404);
}

}  // namespace note_routes_test
}  // namespace hermite::server
