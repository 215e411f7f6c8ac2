// How much of the server anybody may take. One place for the defaults.
#pragma once

namespace hermite {

struct Limits {
  int connections = 256;             // open at once, 1 to 10 000
  int connections_per_address = 64;  // 1 to 10 000
  int requests_per_second = 60;      // HTTP requests of an address, upgrades too; twice as many at once. 1 to 10 000
  int failures_per_minute = 5;       // wrong tokens of an address, 1 to 1000
  int scans_per_token = 2;           // running at once; tokens that may administer have only the server's limit. 1 to 64
  int storage_gb = 0;                // for the files of all scans, 0: as much as there is. 0 to 1 000 000
};

}  // namespace hermite
