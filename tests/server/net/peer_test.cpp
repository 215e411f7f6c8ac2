#include "server/net/peer.h"

#include <gtest/gtest.h>

namespace hermite::server {
namespace {

TEST(Peer, NetworksHoldTheirAddresses) {
  const Network ten = *parse_network("10.0.0.0/8");
  EXPECT_TRUE(lies_in(ten, "10.255.0.1"));
  EXPECT_TRUE(lies_in(ten, "::ffff:10.1.2.3")) << "how an IPv6 socket names it";
  EXPECT_FALSE(lies_in(ten, "11.0.0.1"));
  EXPECT_FALSE(lies_in(ten, "::1"));
  EXPECT_TRUE(lies_in(*parse_network("0.0.0.0/0"), "203.0.113.9"));
  EXPECT_FALSE(lies_in(*parse_network("0.0.0.0/0"), "fd00::1"));
  EXPECT_TRUE(lies_in(*parse_network("fd00::/8"), "fd12::1"));
  EXPECT_TRUE(lies_in(*parse_network("192.0.2.7"), "192.0.2.7"));
  EXPECT_FALSE(lies_in(*parse_network("192.0.2.7"), "192.0.2.6"));
  EXPECT_TRUE(lies_in(*parse_network("192.0.2.6/31"), "192.0.2.7"));
  for (const char* text : {"", "nonsense", "10.0.0", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1",
                           "10.0.0.0/8x", "::/129", "/8"})
    EXPECT_FALSE(parse_network(text).ok()) << text;
  for (const char* text : {"", "unknown", "10.0.0.1:80", "10.0.0.1 "})
    EXPECT_FALSE(lies_in(ten, text)) << text;
}

TEST(Peer, OnlyATrustedProxyIsBelieved) {
  const std::vector<Network> proxies{*parse_network("10.0.0.0/8")};
  const Peer stranger = peer_of("203.0.113.9", false, proxies, "127.0.0.1", "https");
  EXPECT_EQ(stranger.address, "203.0.113.9");
  EXPECT_FALSE(stranger.encrypted);
  const Peer client = peer_of("10.0.0.1", false, proxies, "198.51.100.4", "https");
  EXPECT_EQ(client.address, "198.51.100.4");
  EXPECT_TRUE(client.encrypted);
  EXPECT_FALSE(peer_of("10.0.0.1", false, proxies, "198.51.100.4", "http").encrypted);
  EXPECT_EQ(peer_of("10.0.0.1", false, {}, "198.51.100.4", "https").address, "10.0.0.1");
}

TEST(Peer, AnAddressIsOneHoweverTheProxyWritesIt) {
  const std::vector<Network> proxies{*parse_network("10.0.0.0/8")};
  const auto address = [&proxies](const char* forwarded) {
    return peer_of("10.0.0.1", false, proxies, forwarded, "").address;
  };
  EXPECT_EQ(address("198.51.100.4:4711"), "198.51.100.4");
  EXPECT_EQ(address("::ffff:198.51.100.4"), "198.51.100.4");
  EXPECT_EQ(address("198.51.100.4, [::ffff:10.0.0.2]:80"), "198.51.100.4") << "another proxy";
  EXPECT_EQ(address("[2001:DB8:0::1]:4711"), "2001:db8::1");
  EXPECT_EQ(address("2001:db8::0:1"), "2001:db8::1");
  for (const char* none : {"[", "[]", ":", ":80", "[::1", "1.2.3.4:5:6", "[1.2.3.4"})
    EXPECT_NE(address(none), "") << none;
}

TEST(Peer, WhatAClientMadeUpStandsBeforeItsAddress) {
  const std::vector<Network> proxies{*parse_network("10.0.0.0/8")};
  EXPECT_EQ(peer_of("10.0.0.1", false, proxies, "127.0.0.1, 198.51.100.4", "").address,
            "198.51.100.4");
  EXPECT_EQ(peer_of("10.0.0.1", false, proxies, "127.0.0.1, 198.51.100.4,10.0.0.2", "").address,
            "198.51.100.4")
      << "two proxies";
  EXPECT_EQ(peer_of("10.0.0.1", false, proxies, "198.51.100.4, evil", "").address, "10.0.0.1");
  EXPECT_EQ(peer_of("10.0.0.1", false, proxies, "evil, 10.0.0.2", "").address, "10.0.0.2");
  EXPECT_EQ(peer_of("10.0.0.1", false, proxies, ",,,", "").address, "10.0.0.1");
  EXPECT_FALSE(peer_of("10.0.0.1", false, proxies, "", "https, http").encrypted);
}

}  // namespace
}  // namespace hermite::server
