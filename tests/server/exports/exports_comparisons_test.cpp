// Comparisons among the exports: what becomes of them when a scan goes, when they are stopped, and
// when the server ends. Real clouds and files; the threads are in the test's hands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/output/ply.h"
#include "tests/core/compare/made_corner.h"
#include "tests/support/exports_fixture.h"

namespace hermite::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ComparisonsTest : public test::ExportsFixture {
 protected:
  std::string add_scan(unsigned seed, ScanPhase phase = ScanPhase::kFinished) {
    return add_scan_with("surfels.ply",
                         output::format_ply(test::corner_cloud(test::usual_boxes(), seed, 0.02)),
                         phase);
  }
  void delete_scan(const std::string& id) {
    exports_->forget_comparisons_with(id);
    remove_scan(id);
  }
  Status ask(const std::string& first, const std::string& second,
             const std::string& token = "somebody") {
    return exports_->request_comparison({first, {}, token, false}, second);
  }
  ExportPhase phase(const std::string& first, const std::string& second) {
    return exports_->comparison(first, second)->phase;
  }

  const std::string a_ = add_scan(1), b_ = add_scan(2);
};

TEST_F(ComparisonsTest, OneIsMadeForAllWhoAskAndStaysOverARestart) {
  EXPECT_EQ(phase(a_, b_), ExportPhase::kMissing);
  ASSERT_TRUE(ask(a_, b_).ok());
  ASSERT_TRUE(ask(a_, b_, "somebody else").ok());
  EXPECT_EQ(phase(a_, b_), ExportPhase::kRunning);
  EXPECT_EQ(exports_->waiting_count(), 0u) << "at the same time, and made once";
  settle();
  EXPECT_EQ(phase(a_, b_), ExportPhase::kReady);
  EXPECT_THAT(files(a_), ElementsAre("comparison_" + b_ + ".json", "comparison_" + b_ + ".ply",
                                     "surfels.ply"));
  EXPECT_THAT(files(b_), ElementsAre("compared-by_" + a_, "surfels.ply"));
  start();
  EXPECT_EQ(phase(a_, b_), ExportPhase::kReady);
  ASSERT_EQ(exports_->list_comparisons(a_)->size(), 1u);
  EXPECT_EQ(exports_->list_comparisons(a_)->front().other_scan_id, b_);
  EXPECT_TRUE(exports_->list_comparisons(b_)->empty()) << "the other way around is another one";
  for (const ExportState& one : *exports_->list(a_))
    EXPECT_TRUE(one.other_scan_id.empty()) << "it is no format";
  EXPECT_EQ(exports_->state(a_, "comparison_" + b_).error().code, ErrorCode::kNotFound);
}

TEST_F(ComparisonsTest, NothingIsLeftWhenEitherScanIsDeletedOrSomebodyRemovesIt) {
  for (const bool first_goes : {true, false}) {
    const std::string first = add_scan(1), second = add_scan(2);
    ASSERT_TRUE(ask(first, second).ok());
    settle();
    ASSERT_EQ(phase(first, second), ExportPhase::kReady);
    delete_scan(first_goes ? first : second);
    EXPECT_THAT(files(first_goes ? second : first), ElementsAre("surfels.ply"));
    EXPECT_EQ(exports_->comparison(first, second).error().code, ErrorCode::kNotFound);
  }
  ASSERT_TRUE(ask(a_, b_).ok());
  settle();
  ASSERT_TRUE(exports_->remove_comparison(a_, b_).ok());
  EXPECT_THAT(files(a_), ElementsAre("surfels.ply"));
  EXPECT_THAT(files(b_), ElementsAre("surfels.ply"));
  EXPECT_EQ(exports_->remove_comparison(a_, b_).error().code, ErrorCode::kNotFound);
}

TEST_F(ComparisonsTest, WhileItIsMadeEitherScanMayGo) {
  for (const bool first_goes : {true, false})
    for (const bool while_put : {true, false}) {
      const std::string first = add_scan(1), second = add_scan(2),
                        gone = first_goes ? first : second;
      ASSERT_TRUE(ask(first, second).ok());
      if (while_put) {
        run_one(making_);   // compares
        run_one(network_);  // asks for it to be stored
      }
      delete_scan(gone);
      settle();
      EXPECT_THAT(files(gone), ElementsAre()) << first_goes << while_put;
      EXPECT_THAT(files(first_goes ? second : first), ElementsAre("surfels.ply"))
          << first_goes << while_put;
    }
}

TEST_F(ComparisonsTest, OneThatIsCancelledLeavesNothingAndMayBeAskedForAgain) {
  ASSERT_TRUE(ask(a_, b_).ok());
  ASSERT_TRUE(exports_->remove_comparison(a_, b_).ok());
  EXPECT_EQ(phase(a_, b_), ExportPhase::kMissing);
  EXPECT_EQ(ask(a_, b_).error().code, ErrorCode::kBusy) << "it is just being stopped";
  settle();
  EXPECT_THAT(files(a_), ElementsAre("surfels.ply"));
  EXPECT_THAT(files(b_), ElementsAre("surfels.ply"));
  ASSERT_TRUE(ask(a_, b_).ok());
  settle();
  EXPECT_EQ(phase(a_, b_), ExportPhase::kReady);
}

TEST_F(ComparisonsTest, AServerThatEndsMeanwhileLosesTheRequestAlone) {
  ASSERT_TRUE(ask(a_, b_).ok());
  exports_->stop();
  settle();
  start();
  EXPECT_EQ(phase(a_, b_), ExportPhase::kMissing);
  EXPECT_THAT(files(a_), ElementsAre("surfels.ply"));
}

TEST_F(ComparisonsTest, WhatCannotBeComparedIsSaid) {
  EXPECT_EQ(ask(a_, a_).error().code, ErrorCode::kInvalidArgument);
  const std::string running = add_scan(3, ScanPhase::kRunning), lost = new_scan_id();
  EXPECT_EQ(ask(a_, running).error().code, ErrorCode::kBusy);
  EXPECT_EQ(ask(running, a_).error().code, ErrorCode::kBusy);
  EXPECT_EQ(ask(a_, lost).error().code, ErrorCode::kNotFound);
  const std::string empty = add_scan(4), few = add_scan(5), bare = add_scan(6);
  ASSERT_TRUE(blobs_.put(empty, "surfels.ply", output::format_ply({})).ok());
  ASSERT_TRUE(
      blobs_.put(few, "surfels.ply", output::format_ply({test::corner_cloud({}, 1).front()})).ok());
  ASSERT_TRUE(blobs_.remove(bare, "surfels.ply").ok());
  EXPECT_EQ(ask(a_, empty).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(ask(a_, bare).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(ask(a_, few).ok());
  settle();
  EXPECT_EQ(phase(a_, few), ExportPhase::kFailed);
  EXPECT_THAT(exports_->comparison(a_, few)->message, HasSubstr("the second scan"));
  EXPECT_EQ(exports_->list_comparisons(a_)->size(), 1u) << "a failed one is listed";
}

TEST_F(ComparisonsTest, AScanHasNoMoreThanItsLimit) {
  for (std::size_t i = 0; i < kMaxComparisons; ++i)
    ASSERT_TRUE(blobs_.put(a_, comparison_with(add_scan(1)).file(), "{}").ok());
  const Status more = ask(a_, b_);
  EXPECT_EQ(more.error().code, ErrorCode::kBusy);
  EXPECT_THAT(more.error().message, HasSubstr("of at most 16: remove one that nobody needs"));
}

}  // namespace
}  // namespace hermite::server
