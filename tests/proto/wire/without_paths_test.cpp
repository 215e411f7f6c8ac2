#include "proto/wire/without_paths.h"

#include <gtest/gtest.h>

#include "proto/wire/server_message.h"

namespace hermite::wire {
namespace {

TEST(WithoutPaths, OfAPathTheLastNameIsLeft) {
  EXPECT_EQ(without_paths("writing /srv/data/scans/x/cloud.ply: No space left on device"),
            "writing cloud.ply: No space left on device");
  EXPECT_EQ(without_paths("/data"), "data");
  EXPECT_EQ(without_paths("creating \"/a/b c/d\" failed"), "creating \"d\" failed");
  EXPECT_EQ(without_paths("rename /my data/a.tmp to /my data/a: Permission denied"),
            "rename a: Permission denied");
  EXPECT_EQ(without_paths("making /srv/hermite/: Read-only file system"),
            "making hermite/: Read-only file system");
  EXPECT_EQ(without_paths("in (/srv/x/y) and /srv/z/w (again)"), "in (y) and w (again)");
}

TEST(WithoutPaths, WhatIsNoPathStays) {
  for (const char* message :
       {"", "/", "64 KiB / frame", "HTTP/1.1 or 1.0 is spoken here", "https://example.org/x",
        "and/or", "10.0.0.0/8", "WebSockets are at /api/v1/ws", "a / b"})
    EXPECT_EQ(without_paths(message), message);
}

TEST(WithoutPaths, EveryMessageWithTextGoesThroughIt) {
  const std::string path = "/srv/secret place/scans/x/log";
  for (ServerMessage message :
       {ServerMessage(ErrorMessage{"io", "writing " + path + ": no", false, 0}),
        ServerMessage(ScanState{ScanPhase::kInterrupted, "writing " + path, 0, 0, 0}),
        ServerMessage(NotResumed{"reading " + path})})
    EXPECT_EQ(format_server_message(std::move(message)).find("secret place"), std::string::npos);
}

}  // namespace
}  // namespace hermite::wire
