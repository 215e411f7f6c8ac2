// The small image of a scan over HTTP, of a real server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/thumbnail/thumbnail.h"
#include "server/exports/export_spec.h"
#include "server/store/scan_id.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace thumbnail_route_test {

class ThumbnailRouteTest : public test::RouteTest {
 protected:
  ThumbnailRouteTest() {
    add_scans({test::finished_row(id_), test::finished_row(older_id_)});
    put(id_, thumbnail::kThumbnailName, jpeg_);
    start();
  }
  test::RouteAnswer thumbnail_of(const std::string& scan, const std::string& token) {
    return ask("GET", "/api/v1/scans/" + scan + "/thumbnail.jpg", token);
  }

  const std::string id_ = new_scan_id(), older_id_ = new_scan_id();
  const std::string jpeg_ = *thumbnail::thumbnail_jpeg({});
};

TEST_F(ThumbnailRouteTest, IsTheStoredImage) {
  const test::RouteAnswer answer = thumbnail_of(id_, server_->token());
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_TRUE(answer.body == jpeg_);
  EXPECT_EQ(answer.field("Content-Type"), "image/jpeg");
  EXPECT_NE(answer.field("ETag"), "");
}

TEST_F(ThumbnailRouteTest, ThatOfTheMeshComesFirst) {
  put(id_, kMeshThumbnailFile, "of the edited scan");
  EXPECT_EQ(thumbnail_of(id_, server_->token()).body, "of the edited scan");
}

TEST_F(ThumbnailRouteTest, ThatAScanHasNoneIsNoFailureButThatThereIsNoScanIs) {
  const test::RouteAnswer none = thumbnail_of(older_id_, server_->token());
  EXPECT_EQ(none.status, 204);
  EXPECT_EQ(none.body, "");
  EXPECT_EQ(thumbnail_of(new_scan_id(), server_->token()).status, 404);
  EXPECT_EQ(thumbnail_of(id_, "nobody").status, 401);
}

}  // namespace thumbnail_route_test
}  // namespace hermite::server
