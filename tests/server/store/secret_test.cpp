#include "server/store/secret.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace hermite::server {
namespace {

TEST(Secret, HasItsPrefixAnd256BitsThatNeverRepeat) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string secret = new_secret(kTokenPrefix);
    EXPECT_EQ(secret.size(), kTokenPrefix.size() + 64);
    EXPECT_EQ(secret.substr(0, 4), "hmt_");
    EXPECT_EQ(secret.find_first_not_of("0123456789abcdef", 4), std::string::npos);
    EXPECT_TRUE(seen.insert(secret).second);
  }
}

}  // namespace
}  // namespace hermite::server
