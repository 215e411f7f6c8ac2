#include "server/client/printable.h"

#include <gtest/gtest.h>

namespace hermite::client::printable_test {
namespace {

TEST(Printable, ReplacesControlCharactersAlone) {
  EXPECT_EQ(printable("Küche £5 日本 🪑"), "Küche £5 日本 🪑");
  EXPECT_EQ(printable("a\x1b[2J\r\n\tb\x7f"), "a?[2J???b?");
  EXPECT_EQ(printable("a\xc2\x9b"
                      "2Jb\xc2\x80\xc2\xa0"),
            "a?2Jb?\xc2\xa0")
      << "U+009B begins a command to the terminal as ESC [ does";
  EXPECT_EQ(printable("\xc2"), "\xc2") << "cut short";
  EXPECT_EQ(printable(""), "");
}

}  // namespace
}  // namespace hermite::client::printable_test
