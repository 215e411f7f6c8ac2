// TLS 1.2 and newer by OpenSSL: certificates and whom to trust. Contexts are read-only once made and may be shared.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <memory>
#include <string>

#include "core/base/result.h"

namespace hermite {

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

// `certificate`: PEM, the server's own first, then its chain; `key`: its private key, PEM without a password. kInvalidArgument naming the
// file: not there, not PEM, or a key that is not the certificate's.
Result<TlsContext> server_tls(const std::string& certificate, const std::string& key);

// Believes the certificate authorities of the system, or those of the file `ca` (PEM) alone when it is not empty. The host's name is
// checked against the certificate by whoever connects. kInvalidArgument naming the file.
Result<TlsContext> client_tls(const std::string& ca);

// Believes whoever answers. Only for connections that stay on this machine, where the address says as much as a certificate could.
Result<TlsContext> unverified_client_tls();

}  // namespace hermite
