#include "server/store/secret.h"

#include <gtest/gtest.h>

#include <set>

namespace hermite {
namespace {

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(byte));
    text += digits;
  }
  return text;
}

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

// FIPS 180-2, appendix B.
TEST(Secret, Sha256IsTheStandards) {
  EXPECT_EQ(hex(sha256("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex(sha256("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_NE(sha256(std::string_view("a\0b", 3)), sha256("a"));
}

}  // namespace
}  // namespace hermite
