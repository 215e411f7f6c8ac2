// TLS from end to end: the server with a certificate, our client with and without a reason to trust
// it.
#include "server/net/tls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/objects.h>
#include <openssl/ssl.h>

#include <filesystem>
#include <fstream>

#include "server/client/connection.h"
#include "tests/support/certificate.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::chrono::seconds kPatience(20);

class TlsTest : public testing::Test {
 protected:
  std::unique_ptr<test::RunningServer> serve(const test::CertificateFiles& files) {
    ServiceOptions options = test::test_options(folder_ / "data");
    options.tls_certificate = files.certificate;
    options.tls_key = files.key;
    return std::make_unique<test::RunningServer>(options);
  }
  std::string connect_message(int port, const std::string& ca,
                              const std::string& host = "127.0.0.1") {
    const auto connection = client::Connection::open(
        {host, static_cast<std::uint16_t>(port), "t", true}, kPatience, ca);
    return connection.ok() ? "connected" : connection.error().message;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(TlsTest, AClientThatTrustsTheCertificateConnectsAndTalks) {
  const test::CertificateFiles files =
      test::make_certificate(folder_.path(), "server", "IP:127.0.0.1");
  const auto server = serve(files);
  EXPECT_THAT(server->service().url(), StartsWith("https://127.0.0.1:"));
  auto connection =
      client::Connection::open({"127.0.0.1", static_cast<std::uint16_t>(server->port()), "t", true},
                               kPatience, files.certificate);
  ASSERT_TRUE(connection.ok()) << connection.error().message;
  // Records of TLS in both directions: a message that is none, and the answer as text.
  (*connection)->send(std::string(60'000, 'x'));
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!(*connection)->ended() && std::chrono::steady_clock::now() < deadline) {
    (*connection)->wait_until(deadline);
    (*connection)->take_message();
  }
  ASSERT_TRUE((*connection)->ended());
  EXPECT_THAT((*connection)->ended()->message, HasSubstr("the first message must be a hello"));
}

TEST_F(TlsTest, OthersAreRefusedWithAMessage) {
  const test::CertificateFiles files =
      test::make_certificate(folder_.path(), "server", "IP:127.0.0.1");
  const test::CertificateFiles other =
      test::make_certificate(folder_.path(), "other", "IP:127.0.0.1");
  const auto server = serve(files);
  EXPECT_THAT(connect_message(server->port(), ""), HasSubstr("is not trusted"));
  EXPECT_THAT(connect_message(server->port(), other.certificate), HasSubstr("is not trusted"));
  EXPECT_THAT(connect_message(server->port(), files.certificate, "localhost"),
              HasSubstr("is not trusted"))
      << "the certificate names the address only";
  EXPECT_THAT(connect_message(server->port(), folder_ / "nowhere.pem"), HasSubstr("nowhere.pem"));
  EXPECT_THAT(connect_message(server->port(), files.certificate), "connected");
}

TEST_F(TlsTest, AnExpiredCertificateIsNotTrusted) {
  const test::CertificateFiles files =
      test::make_certificate(folder_.path(), "server", "IP:127.0.0.1", true);
  EXPECT_THAT(connect_message(serve(files)->port(), files.certificate), HasSubstr("expired"));
}

TEST_F(TlsTest, PlainHttpGetsNothingThere) {
  const auto server = serve(test::make_certificate(folder_.path(), "server", "IP:127.0.0.1"));
  test::RawClient client(server->port());
  client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.read_to_end().find("HTTP/1.1 200"), std::string::npos);
}

TEST_F(TlsTest, OnlySuitesWithForwardSecrecyAndAuthenticatedEncryptionAreOffered) {
  const test::CertificateFiles files = test::make_certificate(folder_.path(), "a", "IP:127.0.0.1");
  for (const Result<TlsContext>& context :
       {server_tls(files.certificate, files.key), client_tls("")}) {
    ASSERT_TRUE(context.ok());
    STACK_OF(SSL_CIPHER)* const suites = SSL_CTX_get_ciphers((*context)->native_handle());
    ASSERT_GT(sk_SSL_CIPHER_num(suites), 0);
    for (int i = 0; i < sk_SSL_CIPHER_num(suites); ++i) {
      const SSL_CIPHER* const suite = sk_SSL_CIPHER_value(suites, i);
      EXPECT_TRUE(SSL_CIPHER_is_aead(suite)) << SSL_CIPHER_get_name(suite);
      const int exchange = SSL_CIPHER_get_kx_nid(suite);
      EXPECT_TRUE(exchange == NID_kx_ecdhe || exchange == NID_kx_any) << SSL_CIPHER_get_name(suite);
    }
  }
}

TEST_F(TlsTest, FilesThatDoNotFitAreNamed) {
  const test::CertificateFiles a = test::make_certificate(folder_.path(), "a", "IP:127.0.0.1");
  const test::CertificateFiles b = test::make_certificate(folder_.path(), "b", "IP:127.0.0.1");
  std::ofstream(folder_ / "garbage.pem") << "garbage";
  const auto message_of = [](const Result<TlsContext>& context) {
    return context.ok() ? "well" : context.error().message;
  };
  EXPECT_EQ(message_of(server_tls(a.certificate, a.key)), "well");
  EXPECT_THAT(message_of(server_tls(a.certificate, b.key)), HasSubstr("b.key"));
  EXPECT_THAT(message_of(server_tls(folder_ / "none.pem", a.key)), HasSubstr("none.pem"));
  EXPECT_THAT(message_of(server_tls(a.certificate, folder_ / "none.key")), HasSubstr("none.key"));
  EXPECT_THAT(message_of(server_tls(folder_ / "garbage.pem", a.key)), HasSubstr("garbage.pem"));
  EXPECT_THAT(message_of(client_tls(folder_ / "garbage.pem")), HasSubstr("garbage.pem"));
}

}  // namespace
}  // namespace hermite::server
