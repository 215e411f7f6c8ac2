#include "server/store/http_date.h"

#include <gtest/gtest.h>

namespace hermite::server {
namespace {

TEST(HttpDate, IsInEnglishAndOfGreenwich) {
  EXPECT_EQ(http_date(1'403'712'000'123), "Wed, 25 Jun 2014 16:00:00 GMT");
  EXPECT_EQ(http_date(0), "Thu, 01 Jan 1970 00:00:00 GMT");
}

}  // namespace
}  // namespace hermite::server
