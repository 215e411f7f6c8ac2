// What a Service is made of, taken out of its options. What cannot be is a SetupError, in words that name the option.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/access/access.h"
#include "server/net/peer.h"
#include "server/net/tls.h"
#include "server/routes/static_files.h"
#include "server/scan/scans.h"
#include "server/service/service.h"
#include "server/uploads/uploads.h"

namespace hermite {

// The options as they are, every one within its limits.
ServiceOptions checked(const ServiceOptions& options);

// Where cameras and viewers come in: others than this machine only encrypted, or because somebody insists.
ListenAddress checked_address(const ServiceOptions& options);

// Where monitoring comes in. None: off.
std::optional<ListenAddress> checked_admin_address(const ServiceOptions& options);

std::vector<Network> proxies_of(const ServiceOptions& options);
TlsContext tls_of(const ServiceOptions& options);  // null: nothing is encrypted
ScansOptions scans_options(const ServiceOptions& options);
UploadLimits upload_limits(const ServiceOptions& options);

// In Host and Origin headers: the loopback, where it listens, and what the options add.
AllowedHosts allowed_hosts(const ServiceOptions& options, const ListenAddress& address);

// None, with a warning, where there are none: the service works without its viewer, cameras do not need it.
StaticFiles viewer_files(const std::string& folder);

boost::asio::ip::tcp::acceptor open_port(boost::asio::io_context& context, const ListenAddress& address);

}  // namespace hermite
