// What a Store keeps, in every database. Each is put through it with a world of its own:
//
//   struct World {
//     static std::string missing();  // may be left out: what this machine lacks; not empty: the
//                                    // tests are skipped
//     Store& store();
//     void restart();  // the server ends as it should, and another one opens what it left
//     void die();      // the server is killed between two calls, and another one opens what it
//                      // left
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(Sqlite, StoreContract, World);
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/store/scan_id.h"
#include "server/store/shares.h"
#include "server/store/store.h"
#include "tests/support/store_rows.h"

namespace hermite::test {

template <class World>
class StoreContract : public testing::Test {
 protected:
  void SetUp() override {
    if constexpr (requires { World::missing(); })
      if (const std::string reason = World::missing(); !reason.empty()) GTEST_SKIP() << reason;
  }
  server::Store& store() { return world_.store(); }
  server::JobRow added_job(int priority = 0, std::int64_t created_at_ms = 0,
                           server::JobState state = server::JobState::kQueued) {
    const server::JobRow row = job_row(priority, created_at_ms, state);
    EXPECT_TRUE(store().jobs.add(row).ok());
    return row;
  }
  World world_;
};
TYPED_TEST_SUITE_P(StoreContract);

TYPED_TEST_P(StoreContract, AScanComesBackAsItWasOverARestart) {
  server::ScanRow row = scan_row("a", 1000);
  ASSERT_TRUE(this->store().scans.add(row).ok());
  row.phase = server::ScanPhase::kFinished;
  row.message = "all well";
  row.frames_received = 10;
  row.frames_processed = 9;
  row.frames_dropped = 1;
  row.finished_at_ms = 2000;
  ASSERT_TRUE(this->store().scans.update(row).ok());
  this->world_.restart();
  const Result<server::ScanRow> found = this->store().scans.find("a");
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->title, row.title);
  EXPECT_EQ(found->phase, server::ScanPhase::kFinished);
  EXPECT_EQ(found->message, "all well");
  EXPECT_EQ(found->camera, row.camera);
  EXPECT_EQ(found->frames_received, 10);
  EXPECT_EQ(found->frames_processed, 9);
  EXPECT_EQ(found->frames_dropped, 1);
  EXPECT_EQ(found->created_at_ms, 1000);
  EXPECT_EQ(found->finished_at_ms, 2000);
}

TYPED_TEST_P(StoreContract, AScanGetsAnotherTitleAndStaysTheSameOtherwise) {
  server::ScanRow row = scan_row("a", 1000);
  row.message = "as they were";
  ASSERT_TRUE(this->store().scans.add(row).ok());
  ASSERT_TRUE(this->store().scans.label("a", {"another 'title'", std::nullopt}).ok());
  EXPECT_EQ(this->store().scans.label("b", {"x", std::nullopt}).error().code, ErrorCode::kNotFound);
  this->world_.die();
  EXPECT_EQ(this->store().scans.find("a")->title, "another 'title'");
  EXPECT_EQ(this->store().scans.find("a")->message, "as they were");
}

TYPED_TEST_P(StoreContract, AScanHasTags) {
  server::ScanRow row = scan_row("a");
  row.tags = {"1", "two words", "\xC3\xA4"};
  ASSERT_TRUE(this->store().scans.add(row).ok());
  EXPECT_EQ(this->store().scans.find("a")->tags, row.tags);
  row.tags = {"not written by an update"};
  ASSERT_TRUE(this->store().scans.update(row).ok());
  EXPECT_EQ(this->store().scans.list()->at(0).tags.size(), 3u);
  ASSERT_TRUE(this->store().scans.label("a", {std::nullopt, std::vector<std::string>{"b"}}).ok());
  EXPECT_EQ(this->store().scans.find("a")->tags, std::vector<std::string>{"b"});
  EXPECT_EQ(this->store().scans.find("a")->title, row.title);
  ASSERT_TRUE(this->store().scans.label("a", {std::nullopt, std::vector<std::string>{}}).ok());
  EXPECT_TRUE(this->store().scans.find("a")->tags.empty());
}

TYPED_TEST_P(StoreContract, WhatReturnedWellSurvivesADeath) {
  server::ScanRow scan = scan_row("a");
  ASSERT_TRUE(this->store().scans.add(scan).ok());
  scan.message = "changed";
  ASSERT_TRUE(this->store().scans.update(scan).ok());
  ASSERT_TRUE(this->store().scans.add(scan_row("removed")).ok());
  ASSERT_TRUE(this->store().scans.remove("removed").ok());
  ASSERT_TRUE(this->store().tokens.add(token_row("t")).ok());
  ASSERT_TRUE(this->store().tokens.revoke("t", 5).ok());
  ASSERT_TRUE(this->store().uploads.add({"u", "t", 10, "m", -1, 1, 2}).ok());
  const server::JobRow job = this->added_job();
  ASSERT_TRUE(this->store().jobs.add_line(job.id, {1, "a line"}).ok());
  this->world_.die();
  EXPECT_EQ(this->store().scans.find("a")->message, "changed");
  EXPECT_EQ(this->store().scans.find("removed").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().tokens.find("t")->revoked_at_ms, 5);
  EXPECT_EQ(this->store().uploads.find("u")->length_bytes, 10);
  EXPECT_EQ(this->store().jobs.lines_of(job.id)->size(), 1u);
}

TYPED_TEST_P(StoreContract, WhatWasRefusedHasChangedNothing) {
  ASSERT_TRUE(this->store().scans.add(scan_row("a", 1)).ok());
  server::ScanRow twin = scan_row("a", 2);
  twin.title = "another";
  EXPECT_EQ(this->store().scans.add(twin).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(this->store().scans.find("a")->title, scan_row("a").title);
  ASSERT_TRUE(this->store().tokens.add(token_row("t")).ok());
  server::TokenRow other = token_row("other");
  other.secret_sha256 = digest::sha256("secret of t");
  EXPECT_EQ(this->store().tokens.add(other).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(this->store().tokens.find("other").error().code, ErrorCode::kNotFound);
  const server::JobRow job = this->added_job(3);
  server::JobRow again = job;
  again.priority = 9;
  EXPECT_EQ(this->store().jobs.add(again).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(this->store().jobs.find(job.id)->priority, 3);
  ASSERT_TRUE(this->store().uploads.add({"u", "t", 10, "m", -1, 1, 2}).ok());
  EXPECT_EQ(this->store().uploads.add({"u", "t", 11, "m", -1, 1, 2}).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(this->store().uploads.find("u")->length_bytes, 10);
}

TYPED_TEST_P(StoreContract, WhatIsNotThereIsNotFoundAndNotMade) {
  EXPECT_EQ(this->store().scans.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().scans.update(scan_row("a")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().scans.remove("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().scans.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().tokens.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().tokens.revoke("a", 1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().tokens.touch("a", 1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().tokens.remove("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().uploads.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().uploads.update({"a", "t", 1, "", -1, 0, 0}).error().code,
            ErrorCode::kNotFound);
  EXPECT_EQ(this->store().uploads.remove("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().jobs.find("a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().jobs.update(job_row()).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store().jobs.add_line("a", {0, "y"}).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(this->store().scans.list()->empty());
  EXPECT_TRUE(this->store().tokens.list()->empty());
  EXPECT_TRUE(this->store().uploads.list()->empty());
  EXPECT_TRUE(this->store().jobs.list()->empty());
}

TYPED_TEST_P(StoreContract, IdsAreToldApartByteByByte) {
  for (const char* id : {"a", "A", "a ", "", "%", "_"})
    ASSERT_TRUE(this->store().scans.add(scan_row(id)).ok()) << id;
  ASSERT_TRUE(this->store().scans.remove("A").ok());
  EXPECT_THAT(ids_of(this->store().scans.list()),
              testing::UnorderedElementsAre("a", "a ", "", "%", "_"));
}

TYPED_TEST_P(StoreContract, ScansAreListedNewestFirst) {
  for (const auto& [id, time] : {std::pair{"b", 2}, std::pair{"c", 3}, std::pair{"a", 1}})
    ASSERT_TRUE(this->store().scans.add(scan_row(id, time)).ok());
  EXPECT_THAT(ids_of(this->store().scans.list()), testing::ElementsAre("c", "b", "a"));
}

TYPED_TEST_P(StoreContract, EveryScanIsListedOnceHoweverManyThereAre) {
  constexpr int kCount = server::kMaxListedScans + 7;
  for (int i = 0; i < kCount; ++i)
    ASSERT_TRUE(this->store().scans.add(scan_row("scan " + std::to_string(i), 1000 + i / 3)).ok());
  std::vector<std::string> ids = ids_of(this->store().scans.list());
  ASSERT_EQ(ids.size(), static_cast<std::size_t>(server::kMaxListedScans));
  const std::vector<std::string> older = ids_of(this->store().scans.list_older_than(ids.back()));
  EXPECT_EQ(older.size(), 7u);
  EXPECT_EQ(older.back(), "scan 2") << "the oldest, by its id among those of the same moment";
  ids.insert(ids.end(), older.begin(), older.end());
  EXPECT_EQ(std::set(ids.begin(), ids.end()).size(), static_cast<std::size_t>(kCount));
  EXPECT_TRUE(this->store().scans.list_older_than(ids.back())->empty());
  EXPECT_EQ(this->store().scans.list_older_than("nobody").error().code, ErrorCode::kNotFound);
}

TYPED_TEST_P(StoreContract, ScansThatADeadServerLeftRunningAreFoundOldestFirst) {
  ASSERT_TRUE(this->store().scans.add(scan_row("younger", 3)).ok());
  ASSERT_TRUE(this->store().scans.add(scan_row("older", 1)).ok());
  server::ScanRow finished = scan_row("finished", 2);
  finished.phase = server::ScanPhase::kFinished;
  ASSERT_TRUE(this->store().scans.add(finished).ok());
  this->world_.die();
  EXPECT_THAT(ids_of(this->store().scans.running()), testing::ElementsAre("older", "younger"));
}

TYPED_TEST_P(StoreContract, AScanOfAJobIsNoneThatTheServerGoesOnWith) {
  ASSERT_TRUE(this->store().scans.add(scan_row("a")).ok());
  server::JobRow job = this->added_job();
  job.scan_id = "a";
  ASSERT_TRUE(this->store().jobs.update(job).ok());
  EXPECT_THAT(ids_of(this->store().scans.running()), testing::ElementsAre());
  job.state = server::JobState::kFailed;
  ASSERT_TRUE(this->store().jobs.update(job).ok());
  EXPECT_THAT(ids_of(this->store().scans.running()), testing::ElementsAre("a"));
}

TYPED_TEST_P(StoreContract, SaysThatItTakesChangesAndIsWhole) {
  EXPECT_TRUE(this->store().check_writable().ok());
  EXPECT_TRUE(this->store().check_writable().ok()) << "and leaves no transaction behind";
  ASSERT_TRUE(this->store().scans.add(scan_row("a")).ok());
  EXPECT_TRUE(this->store().check_integrity().ok());
  EXPECT_TRUE(this->store().scans.add(scan_row("b")).ok()) << "the check leaves none behind either";
}

TYPED_TEST_P(StoreContract, ATokenIsFoundByItsHash) {
  server::TokenRow row = token_row("a");
  row.expires_at_ms = 77;
  ASSERT_TRUE(this->store().tokens.add(row).ok());
  const Result<server::TokenRow> found =
      this->store().tokens.with_secret(digest::sha256("secret of a"));
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->id, "a");
  EXPECT_EQ(found->name, "name of a");
  EXPECT_EQ(found->scopes, row.scopes);
  EXPECT_EQ(found->scan_id, "");
  EXPECT_EQ(found->expires_at_ms, 77);
  EXPECT_EQ(found->revoked_at_ms, 0);
  for (const std::string& secret :
       {digest::sha256("secret of b"), std::string("secret of a"), std::string()})
    EXPECT_EQ(this->store().tokens.with_secret(secret).error().code, ErrorCode::kNotFound);
}

TYPED_TEST_P(StoreContract, ASecretThatIsNoHashIsNoToken) {
  server::TokenRow plain = token_row("c");
  plain.secret_sha256 = "no hash";
  EXPECT_FALSE(this->store().tokens.add(plain).ok());
}

TYPED_TEST_P(StoreContract, ARevocationStaysAsItWasFirst) {
  ASSERT_TRUE(this->store().tokens.add(token_row("a")).ok());
  ASSERT_TRUE(this->store().tokens.revoke("a", 100).ok());
  ASSERT_TRUE(this->store().tokens.revoke("a", 200).ok());
  EXPECT_EQ(this->store().tokens.find("a")->revoked_at_ms, 100);
}

TYPED_TEST_P(StoreContract, ATokenKnowsItsLastUse) {
  ASSERT_TRUE(this->store().tokens.add(token_row("a")).ok());
  EXPECT_EQ(this->store().tokens.find("a")->used_at_ms, 0);
  ASSERT_TRUE(this->store().tokens.touch("a", 300).ok());
  EXPECT_EQ(this->store().tokens.find("a")->used_at_ms, 300);
}

TYPED_TEST_P(StoreContract, TokensAreListedNewestFirst) {
  for (const auto& [id, time] : {std::pair{"b", 2}, std::pair{"c", 3}, std::pair{"a", 1}})
    ASSERT_TRUE(this->store().tokens.add(token_row(id, time)).ok());
  EXPECT_THAT(ids_of(this->store().tokens.list()), testing::ElementsAre("c", "b", "a"));
}

TYPED_TEST_P(StoreContract, AShareLinkIsOfAScanThatIsThereAndGoesWithIt) {
  EXPECT_EQ(this->store().tokens.add(share_row("s", "none")).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  ASSERT_TRUE(this->store().tokens.add(share_row("s", "scan")).ok());
  EXPECT_EQ(this->store().tokens.find("s")->scan_id, "scan");
  ASSERT_TRUE(this->store().scans.remove("scan").ok());
  EXPECT_EQ(this->store().tokens.find("s").error().code, ErrorCode::kNotFound);
}

TYPED_TEST_P(StoreContract, MeasurementsAreOfAScanThatIsThereAndGoWithIt) {
  server::MeasurementRow row{"m",
                             "scan",
                             "a 'door'",
                             "height",
                             {{0.1, 1e-9, -3}, {4, 5, 6}},
                             {{0, 0, -1}, {0.6, 0.8, 0}},
                             {{0, -1, 0}},
                             1.25,
                             0.003,
                             7};
  EXPECT_EQ(this->store().measurements.add(row).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  ASSERT_TRUE(this->store().measurements.add(row).ok());
  EXPECT_EQ(this->store().measurements.add(row).error().code, ErrorCode::kInvalidArgument);
  this->world_.restart();
  const auto rows = this->store().measurements.of_scan("scan");
  ASSERT_EQ(rows->size(), 1u);
  EXPECT_EQ((*rows)[0].name, row.name);
  EXPECT_EQ((*rows)[0].kind, row.kind);
  EXPECT_EQ((*rows)[0].points, row.points);
  EXPECT_EQ((*rows)[0].normals, row.normals);
  EXPECT_EQ((*rows)[0].up, row.up);
  EXPECT_EQ((*rows)[0].value, row.value);
  EXPECT_EQ((*rows)[0].half_width, row.half_width);
  EXPECT_EQ((*rows)[0].created_at_ms, row.created_at_ms);
  row.id = "of another kind";
  row.kind = "weight";
  EXPECT_EQ(this->store().measurements.add(row).error().code, ErrorCode::kInvalidArgument);
  row.kind = "area";
  row.normals.clear();
  row.up.reset();
  for (int i = 1; i < server::kMaxMeasurementsPerScan; ++i) {
    row.id = std::to_string(i);
    ASSERT_TRUE(this->store().measurements.add(row).ok());
  }
  row.id = "one more";
  EXPECT_EQ(this->store().measurements.add(row).error().code, ErrorCode::kBusy);
  EXPECT_EQ(this->store().measurements.remove("another", "1").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(this->store().measurements.remove("scan", "1").ok());
  EXPECT_TRUE(this->store().measurements.add(row).ok());
  ASSERT_TRUE(this->store().scans.remove("scan").ok());
  EXPECT_TRUE(this->store().measurements.of_scan("scan")->empty());
}

TYPED_TEST_P(StoreContract, NotesAreOfAScanThatIsThereAndGoWithIt) {
  server::NoteRow row{"n",
                      "scan",
                      {0.1, 1e-9, -3},
                      server::NoteView{{1, 2, 3}, {4, 5, 6.5}},
                      "a 'crack';\n\xF0\x9F\xA7\xB1",
                      1,
                      7,
                      7};
  EXPECT_EQ(this->store().notes.add(row).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(this->store().notes.of_scan("scan")->empty());
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  ASSERT_TRUE(this->store().scans.add(scan_row("other")).ok());
  ASSERT_TRUE(this->store().notes.add(row).ok());
  EXPECT_EQ(this->store().notes.add(row).error().code, ErrorCode::kInvalidArgument);
  server::NoteRow older{"m", "scan", {}, std::nullopt, "older", 1, 6, 6};
  ASSERT_TRUE(this->store().notes.add(older).ok());
  older.id = "nowhere";
  older.position_m[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(this->store().notes.add(older).error().code, ErrorCode::kInvalidArgument);
  this->world_.restart();
  const auto rows = this->store().notes.of_scan("scan");
  ASSERT_THAT(ids_of(rows), testing::ElementsAre("m", "n"));
  EXPECT_FALSE((*rows)[0].view);
  const server::NoteRow& read = (*rows)[1];
  EXPECT_EQ(read.scan_id, "scan");
  EXPECT_EQ(read.position_m, row.position_m);
  ASSERT_TRUE(read.view);
  EXPECT_EQ(read.view->position_m, row.view->position_m);
  EXPECT_EQ(read.view->target_m, row.view->target_m);
  EXPECT_EQ(read.text, row.text);
  EXPECT_EQ(read.version, 1);
  EXPECT_EQ(read.created_at_ms, 7);
  EXPECT_EQ(read.changed_at_ms, 7);
  row.scan_id = "other";
  for (int i = 0; i < server::kMaxNotesPerScan; ++i) {
    row.id = std::to_string(i);
    ASSERT_TRUE(this->store().notes.add(row).ok());
  }
  row.id = "one more";
  EXPECT_EQ(this->store().notes.add(row).error().code, ErrorCode::kBusy);
  ASSERT_TRUE(this->store().notes.remove("other", "1", 1)->is_done);
  EXPECT_TRUE(this->store().notes.add(row).ok());
  ASSERT_TRUE(this->store().scans.remove("other").ok());
  EXPECT_TRUE(this->store().notes.of_scan("other")->empty());
  EXPECT_EQ(this->store().notes.of_scan("scan")->size(), 2u);
}

TYPED_TEST_P(StoreContract, ANoteIsChangedOnlyInTheVersionThatWasRead) {
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  ASSERT_TRUE(
      this->store().notes.add({"n", "scan", {1, 2, 3}, std::nullopt, "first", 1, 7, 7}).ok());
  const auto changed =
      this->store().notes.change_text({"n", "scan", {}, std::nullopt, "second", 1, 0, 9});
  ASSERT_TRUE(changed.ok()) << changed.error().message;
  EXPECT_TRUE(changed->is_done);
  const auto late = this->store().notes.change_text(
      {"n", "scan", {}, std::nullopt, "of somebody else", 1, 0, 10});
  ASSERT_TRUE(late.ok()) << late.error().message;
  EXPECT_FALSE(late->is_done);
  const auto not_removed = this->store().notes.remove("scan", "n", 1);
  ASSERT_TRUE(not_removed.ok()) << not_removed.error().message;
  EXPECT_FALSE(not_removed->is_done);
  this->world_.die();
  const auto rows = this->store().notes.of_scan("scan");
  ASSERT_EQ(rows->size(), 1u);
  for (const server::NoteRow& note : {changed->note, late->note, not_removed->note, (*rows)[0]}) {
    EXPECT_EQ(note.text, "second");
    EXPECT_EQ(note.version, 2);
    EXPECT_EQ(note.position_m, (std::array<double, 3>{1, 2, 3}));
    EXPECT_EQ(note.created_at_ms, 7);
    EXPECT_EQ(note.changed_at_ms, 9);
  }
  EXPECT_EQ(this->store()
                .notes.change_text({"n", "another", {}, std::nullopt, "third", 2, 0, 9})
                .error()
                .code,
            ErrorCode::kNotFound);
  EXPECT_EQ(this->store().notes.remove("another", "n", 2).error().code, ErrorCode::kNotFound);
  const auto removed = this->store().notes.remove("scan", "n", 2);
  ASSERT_TRUE(removed.ok()) << removed.error().message;
  EXPECT_TRUE(removed->is_done);
  EXPECT_EQ(removed->note.text, "second");
  EXPECT_EQ(this->store().notes.remove("scan", "n", 2).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(this->store()
                .notes.change_text({"n", "scan", {}, std::nullopt, "third", 2, 0, 9})
                .error()
                .code,
            ErrorCode::kNotFound);
}

TYPED_TEST_P(StoreContract, AShareLinkMayOnlyLook) {
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  server::TokenRow row = share_row("s", "scan");
  row.scopes.scan = true;
  EXPECT_EQ(this->store().tokens.add(row).error().code, ErrorCode::kInvalidArgument);
}

TYPED_TEST_P(StoreContract, TokensThatEndedLongAgoAreForgotten) {
  for (const char* id : {server::kFirstTokenId, "revoked", "active"})
    ASSERT_TRUE(this->store().tokens.add(token_row(id)).ok());
  for (const char* id : {server::kFirstTokenId, "revoked"})
    ASSERT_TRUE(this->store().tokens.revoke(id, 100).ok());
  server::TokenRow expired = token_row("expired");
  expired.expires_at_ms = 100;
  ASSERT_TRUE(this->store().tokens.add(expired).ok());
  EXPECT_EQ(*this->store().tokens.forget(100), 0);
  EXPECT_EQ(*this->store().tokens.forget(101), 2);
  EXPECT_TRUE(this->store().tokens.find(server::kFirstTokenId).ok())
      << "or its file's secret would come to life again";
  EXPECT_TRUE(this->store().tokens.find("active").ok());
}

TYPED_TEST_P(StoreContract, AJobComesBackAsItWasOverARestart) {
  server::JobRow row = this->added_job(7, 1000);
  row.state = server::JobState::kFailed;
  row.message = "no 'camera'";
  row.attempt_count = 2;
  row.scan_id = server::new_scan_id();
  row.started_at_ms = 2000;
  row.finished_at_ms = 3000;
  ASSERT_TRUE(this->store().jobs.update(row).ok());
  this->world_.restart();
  const Result<server::JobRow> found = this->store().jobs.find(row.id);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->title, row.title);
  EXPECT_EQ(found->message, row.message);
  EXPECT_EQ(found->state, server::JobState::kFailed);
  EXPECT_EQ(found->priority, 7);
  EXPECT_EQ(found->attempt_count, 2);
  EXPECT_EQ(found->scan_id, row.scan_id);
  EXPECT_EQ(found->finished_at_ms, 3000);
}

TYPED_TEST_P(StoreContract, TheNextJobIsTheHighestAndThenTheOldest) {
  const server::JobRow late = this->added_job(0, 2000), early = this->added_job(0, 1000),
                       urgent = this->added_job(5, 3000), last = this->added_job(-5, 0);
  this->added_job(99, 0, server::JobState::kFinished);
  EXPECT_THAT(ids_of(this->store().jobs.in_state(server::JobState::kQueued)),
              testing::ElementsAre(urgent.id, early.id, late.id, last.id));
}

TYPED_TEST_P(StoreContract, JobsAreCountedByState) {
  for (int i = 0; i < 3; ++i) this->added_job();
  this->added_job(0, 0, server::JobState::kFailed);
  const auto counts = this->store().jobs.count();
  ASSERT_TRUE(counts.ok());
  EXPECT_EQ(*counts, (std::map<server::JobState, int>{{server::JobState::kQueued, 3},
                                                      {server::JobState::kRunning, 0},
                                                      {server::JobState::kFinished, 0},
                                                      {server::JobState::kFailed, 1},
                                                      {server::JobState::kCancelled, 0}}));
}

TYPED_TEST_P(StoreContract, TheLogOfAJobIsBounded) {
  const server::JobRow row = this->added_job();
  for (int i = 0; i < server::kMaxJobLines + 50; ++i)
    ASSERT_TRUE(this->store().jobs.add_line(row.id, {i, "line " + std::to_string(i)}).ok());
  const Result<std::vector<server::JobLine>> lines = this->store().jobs.lines_of(row.id);
  ASSERT_TRUE(lines.ok());
  ASSERT_EQ(lines->size(), static_cast<std::size_t>(server::kMaxJobLines + 1));
  EXPECT_EQ(lines->front().message, "line 0");
  EXPECT_EQ(lines->back().message, "what follows is left out");
}

TYPED_TEST_P(StoreContract, OldJobsAreForgottenWithTheirLogs) {
  server::JobRow old = this->added_job(0, 0, server::JobState::kFinished);
  const server::JobRow waiting = this->added_job();
  ASSERT_TRUE(this->store().jobs.add_line(old.id, {0, "x"}).ok());
  old.finished_at_ms = 10;
  ASSERT_TRUE(this->store().jobs.update(old).ok());
  EXPECT_EQ(*this->store().jobs.forget(10), 0);
  EXPECT_EQ(*this->store().jobs.forget(11), 1);
  EXPECT_FALSE(this->store().jobs.find(old.id).ok());
  EXPECT_TRUE(this->store().jobs.lines_of(old.id)->empty());
  EXPECT_TRUE(this->store().jobs.find(waiting.id).ok());
}

TYPED_TEST_P(StoreContract, AnUploadComesBackAsItWasOverARestart) {
  server::UploadRow row{server::new_scan_id(), "t", -1, "filename Zg==", -1, 1, 2};
  ASSERT_TRUE(this->store().uploads.add(row).ok());
  row.length_bytes = 5;
  row.unchecked_from = 3;
  row.expires_at_ms = 9;
  ASSERT_TRUE(this->store().uploads.update(row).ok());
  this->world_.restart();
  const Result<server::UploadRow> found = this->store().uploads.find(row.id);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->length_bytes, 5);
  EXPECT_EQ(found->unchecked_from, 3);
  EXPECT_EQ(found->expires_at_ms, 9);
  EXPECT_EQ(found->metadata, "filename Zg==");
  EXPECT_EQ(this->store().uploads.list()->size(), 1u);
  EXPECT_TRUE(this->store().uploads.remove(row.id).ok());
  EXPECT_TRUE(this->store().uploads.list()->empty());
}

// Calls `add` with the ids of twenty tokens, each until it is refused; how often it went well.
template <class Add>
std::int64_t fill(Add add) {
  std::int64_t added = 0;
  for (int token = 0; token < 20; ++token)
    while (added < 10'000 && add("token" + std::to_string(token))) ++added;
  return added;
}

TYPED_TEST_P(StoreContract, ThereAreOnlySoManyUploads) {
  ASSERT_TRUE(this->store().tokens.add(admin_row("admin")).ok());
  const auto add = [this](const std::string& token) {
    return this->store().uploads.add({server::new_scan_id(), token, 1, "", -1, 0, 0}).ok();
  };
  EXPECT_EQ(fill(add), server::kUploadShare.in_all - server::kUploadShare.for_admins);
  EXPECT_EQ(this->store().uploads.add({server::new_scan_id(), "t", 1, "", -1, 0, 0}).error().code,
            ErrorCode::kBusy);
  for (int i = 0; i < server::kUploadShare.for_admins; ++i) ASSERT_TRUE(add("admin"));
  EXPECT_FALSE(add("admin"));
}

TYPED_TEST_P(StoreContract, ThereAreOnlySoManyJobsThatHaveNotEnded) {
  ASSERT_TRUE(this->store().tokens.add(admin_row("admin")).ok());
  std::vector<server::JobRow> added;
  const auto add = [this, &added](const std::string& token) {
    server::JobRow row = job_row();
    row.token_id = token;
    added.push_back(row);
    return this->store().jobs.add(row).ok();
  };
  EXPECT_EQ(fill(add), server::kJobShare.in_all - server::kJobShare.for_admins);
  EXPECT_TRUE(add("admin"));
  server::JobRow ended = added.front();
  ended.state = server::JobState::kFailed;
  ASSERT_TRUE(this->store().jobs.update(ended).ok());
  EXPECT_FALSE(add("another")) << "an administrator has its place";
  added[1].state = server::JobState::kFailed;
  ASSERT_TRUE(this->store().jobs.update(added[1]).ok());
  EXPECT_TRUE(add("another"));
  ended.state = server::JobState::kQueued;
  EXPECT_EQ(this->store().jobs.update(ended).error().code, ErrorCode::kBusy)
      << "who tries again needs a place, too";
}

TYPED_TEST_P(StoreContract, ShareLinksThatHaveEndedCountForNothing) {
  ASSERT_TRUE(this->store().tokens.add(admin_row("admin")).ok());
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  int number = 0;
  const auto add = [this, &number](const std::string& token, std::int64_t now_ms,
                                   std::int64_t expires_at_ms) {
    server::TokenRow row = share_row("s" + std::to_string(number++), "scan");
    row.made_by = token;
    row.created_at_ms = now_ms;
    row.expires_at_ms = expires_at_ms;
    return this->store().tokens.add(row);
  };
  for (int i = 0; i < server::kShareLinkShare.per_token; ++i) ASSERT_TRUE(add("t", 0, 1000).ok());
  EXPECT_EQ(add("t", 999, 2000).error().code, ErrorCode::kBusy);
  EXPECT_TRUE(add("another", 999, 2000).ok());
  EXPECT_TRUE(add("t", 1000, 2000).ok()) << "those before have expired";
  for (int i = 1; i < server::kShareLinkShare.per_token; ++i) ASSERT_TRUE(add("t", 1000, 0).ok());
  EXPECT_FALSE(add("t", 1000, 0).ok());
  ASSERT_TRUE(this->store().tokens.revoke("s" + std::to_string(number - 3), 1000).ok());
  EXPECT_TRUE(add("t", 1000, 0).ok());
  EXPECT_TRUE(add("admin", 0, 0).ok());
}

TYPED_TEST_P(StoreContract, OfWhatHasEndedTheNewestStay) {
  ASSERT_TRUE(this->store().scans.add(scan_row("scan")).ok());
  server::TokenRow last;
  for (int i = 0; i < server::kMaxEndedLinksPerToken + 20; ++i) {
    last = share_row("s" + std::to_string(i), "scan");
    last.made_by = "t";
    last.created_at_ms = i + 1;
    ASSERT_TRUE(this->store().tokens.add(last).ok());
    ASSERT_TRUE(this->store().tokens.revoke(last.id, i + 1).ok());
  }
  EXPECT_LE(this->store().tokens.list()->size(),
            static_cast<std::size_t>(server::kMaxEndedLinksPerToken + 1));
  EXPECT_FALSE(this->store().tokens.find("s0").ok());
  EXPECT_TRUE(this->store().tokens.find(last.id).ok());
}

TYPED_TEST_P(StoreContract, AScanKnowsItsTokenAndWhetherItIsToBeRebuilt) {
  server::ScanRow row = scan_row("a");
  row.token_id = "t";
  ASSERT_TRUE(this->store().scans.add(row).ok());
  ASSERT_TRUE(this->store().scans.add(scan_row("b")).ok());
  row.to_be_rebuilt = true;
  ASSERT_TRUE(this->store().scans.update(row).ok());
  this->world_.restart();
  EXPECT_EQ(this->store().scans.find("a")->token_id, "t");
  EXPECT_TRUE(this->store().scans.find("a")->to_be_rebuilt);
  EXPECT_FALSE(this->store().scans.find("b")->to_be_rebuilt);
  EXPECT_FALSE(*this->store().scans.next_to_rebuild()) << "it runs";
  row.phase = server::ScanPhase::kInterrupted;
  ASSERT_TRUE(this->store().scans.update(row).ok());
  ASSERT_TRUE(*this->store().scans.next_to_rebuild());
  EXPECT_EQ((*this->store().scans.next_to_rebuild())->id, "a");
  EXPECT_THAT(*this->store().scans.of_token("t"), testing::ElementsAre("a"));
}

REGISTER_TYPED_TEST_SUITE_P(
    StoreContract, AScanComesBackAsItWasOverARestart, AScanGetsAnotherTitleAndStaysTheSameOtherwise,
    AScanHasTags, WhatReturnedWellSurvivesADeath, WhatWasRefusedHasChangedNothing,
    WhatIsNotThereIsNotFoundAndNotMade, IdsAreToldApartByteByByte, ScansAreListedNewestFirst,
    EveryScanIsListedOnceHoweverManyThereAre, ScansThatADeadServerLeftRunningAreFoundOldestFirst,
    AScanOfAJobIsNoneThatTheServerGoesOnWith, SaysThatItTakesChangesAndIsWhole,
    ATokenIsFoundByItsHash, ASecretThatIsNoHashIsNoToken, ARevocationStaysAsItWasFirst,
    ATokenKnowsItsLastUse, TokensAreListedNewestFirst, AShareLinkIsOfAScanThatIsThereAndGoesWithIt,
    MeasurementsAreOfAScanThatIsThereAndGoWithIt, NotesAreOfAScanThatIsThereAndGoWithIt,
    ANoteIsChangedOnlyInTheVersionThatWasRead, AShareLinkMayOnlyLook,
    TokensThatEndedLongAgoAreForgotten, AJobComesBackAsItWasOverARestart,
    TheNextJobIsTheHighestAndThenTheOldest, JobsAreCountedByState, TheLogOfAJobIsBounded,
    OldJobsAreForgottenWithTheirLogs, AnUploadComesBackAsItWasOverARestart,
    ThereAreOnlySoManyUploads, ThereAreOnlySoManyJobsThatHaveNotEnded,
    ShareLinksThatHaveEndedCountForNothing, OfWhatHasEndedTheNewestStay,
    AScanKnowsItsTokenAndWhetherItIsToBeRebuilt);

}  // namespace hermite::test
