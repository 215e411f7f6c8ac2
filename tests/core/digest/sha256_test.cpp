#include "core/digest/sha256.h"

#include <gtest/gtest.h>

namespace hermite::digest {
namespace {

// FIPS 180-2, appendix B.
TEST(Sha256, IsTheStandards) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc").size(), 32u);
  EXPECT_NE(sha256(std::string_view("a\0b", 3)), sha256("a")) << "a zero ends nothing";
}

TEST(Hex, IsTwoDigitsForEachByte) {
  EXPECT_EQ(hex(""), "");
  EXPECT_EQ(hex(std::string_view("\0\x0f\x80\xff", 4)), "000f80ff");
}

}  // namespace
}  // namespace hermite::digest
