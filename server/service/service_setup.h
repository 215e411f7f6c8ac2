// Creates the parts of a Service from its options. Invalid options are SetupErrors, with a message
// that names the option.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/access/access.h"
#include "server/database/database.h"
#include "server/net/peer.h"
#include "server/net/tls.h"
#include "server/routes/static_files.h"
#include "server/scan/scans.h"
#include "server/service/service.h"
#include "server/uploads/uploads.h"

namespace hermite::server {

// Returns the options unchanged, after checking every one against its limits.
ServiceOptions checked(const ServiceOptions& options);

// Returns the address for cameras and viewers. Other addresses than loopback ones require TLS, or
// the option that allows them without.
ListenAddress checked_address(const ServiceOptions& options);

// Returns the address for monitoring; std::nullopt: off.
std::optional<ListenAddress> checked_admin_address(const ServiceOptions& options);

// Opens the database of the folder of data, which is locked (rows_place.h).
std::unique_ptr<Database> opened_rows(const ServiceOptions& options);

std::string frame_ancestors_of(const ServiceOptions& options);  // access.h
std::vector<Network> proxies_of(const ServiceOptions& options);
TlsContext tls_of(const ServiceOptions& options);  // nullptr: not encrypted
ScansOptions scans_options(const ServiceOptions& options);
UploadLimits upload_limits(const ServiceOptions& options);

// Returns the hosts allowed in Host and Origin headers: loopback names, the listening address, and
// those of the options.
AllowedHosts allowed_hosts(const ServiceOptions& options, const ListenAddress& address);

// Returns no files, with a warning, if there are none: the service works without its viewer, which
// cameras do not need.
StaticFiles viewer_files(const std::string& folder);

boost::asio::ip::tcp::acceptor open_port(boost::asio::io_context& context,
                                         const ListenAddress& address);

}  // namespace hermite::server
