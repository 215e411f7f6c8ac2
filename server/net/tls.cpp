#include "server/net/tls.h"

#include <fmt/core.h>
#include <openssl/ssl.h>

namespace hermite::server {

namespace {

namespace ssl = boost::asio::ssl;
using boost::system::error_code;

Error bad_file(const std::string& what, const std::string& file, const error_code& error) {
  return {ErrorCode::kInvalidArgument, fmt::format("{} {}: {}", what, file, error.message())};
}

Result<TlsContext> base(ssl::context::method method) {
  auto context = std::make_shared<ssl::context>(method);
  if (SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION) != 1)
    return Error{ErrorCode::kUnsupported, "this OpenSSL has no TLS 1.2"};
  // For TLS 1.2, allows only what TLS 1.3 has as well: authenticated encryption and forward secrecy
  // (RFC 9325, 4.2).
  if (SSL_CTX_set_cipher_list(context->native_handle(), "ECDHE+AESGCM:ECDHE+CHACHA20") != 1)
    return Error{ErrorCode::kUnsupported, "this OpenSSL has no ECDHE with AES-GCM"};
  return context;
}

}  // namespace

Result<TlsContext> server_tls(const std::string& certificate, const std::string& key) {
  Result<TlsContext> context = base(ssl::context::tls_server);
  if (!context.ok()) return context;
  ssl::context& server = **context;
  error_code error;
  // By default OpenSSL asks on the terminal.
  server.set_password_callback(
      [](std::size_t, ssl::context::password_purpose) { return std::string(); }, error);
  server.use_certificate_chain_file(certificate, error);
  if (error) return bad_file("TLS certificate", certificate, error);
  server.use_private_key_file(key, ssl::context::pem, error);
  if (error) return bad_file("TLS key", key, error);
  if (SSL_CTX_check_private_key(server.native_handle()) != 1)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("TLS key {} is not that of the certificate {}", key, certificate)};
  // Renegotiation lets a client cause useless work; compression leaks plaintext.
  SSL_CTX_set_options(server.native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                                  SSL_OP_CIPHER_SERVER_PREFERENCE);
  return context;
}

Result<TlsContext> client_tls(const std::string& ca) {
  Result<TlsContext> context = base(ssl::context::tls_client);
  if (!context.ok()) return context;
  error_code error;
  if (ca.empty())
    (*context)->set_default_verify_paths(error);
  else
    (*context)->load_verify_file(ca, error);
  if (error) return bad_file("certificate authorities", ca, error);
  (*context)->set_verify_mode(ssl::verify_peer, error);
  return context;
}

Result<TlsContext> unverified_client_tls() { return base(ssl::context::tls_client); }

}  // namespace hermite::server
