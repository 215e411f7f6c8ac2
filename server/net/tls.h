// TLS 1.2 and newer by OpenSSL: certificates and trust. Contexts are read-only once created and may
// be shared.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

// `certificate` is a PEM file with the server's certificate first, followed by its chain; `key` is
// its private key, PEM without a password. kInvalidArgument naming the file: missing, not PEM, or a
// key that does not belong to the certificate.
Result<TlsContext> server_tls(const std::string& certificate, const std::string& key);

// Trusts the certificate authorities of the system or, if `ca` is not empty, only those of that PEM
// file. The code that connects checks the name of the host against the certificate.
// kInvalidArgument naming the file.
Result<TlsContext> client_tls(const std::string& ca);

// Accepts any certificate. Only for connections within this machine, where the address proves as
// much as a certificate could.
Result<TlsContext> unverified_client_tls();

}  // namespace hermite::server
