#!/usr/bin/env bash
# From nothing to a finished scan in the browser: installs, builds, starts the server, streams the synthetic room into it, and prints where to look.
#
#   deploy/demo.sh     keeps the server running until Ctrl-C
#   DEMO_EXIT=1        ends once the scan is finished (so does CI=true)
#   DEMO_SEQUENCE=...  streams this instead: a folder (TUM, ICL-NUIM, 7-Scenes) or synthetic:options
#   DEMO_DATA=FOLDER   keeps scans there instead of build/demo-data
set -euo pipefail
cd "$(dirname "$0")/.."
source deploy/install.sh

readonly kPort=8080
readonly sequence=${DEMO_SEQUENCE:-synthetic:frames=150}
readonly data=${DEMO_DATA:-build/demo-data}

build() {
  install_packages
  provide_node
  install_viewer
  npm --prefix web run --silent build
  cmake --preset release >/dev/null
  cmake --build --preset release --target hermite hermite-client
}

port_is_free() {
  ! (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null
}

# Sets `server` (process) and `url` (with the token).
start_server() {
  local listen=127.0.0.1:$kPort said=build/demo-server.txt
  port_is_free $kPort || listen=127.0.0.1:0
  build/release/server/hermite serve --listen "$listen" --data "$data" --web-dir web/dist >"$said" &
  server=$!
  trap 'kill "$server" 2>/dev/null; wait "$server" || true' EXIT
  for _ in $(seq 300); do
    url=$(head -1 "$said")
    [ -z "$url" ] || return 0
    kill -0 "$server" 2>/dev/null || break
    sleep 0.2
  done
  echo "The server did not start." >&2
  exit 1
}

build
start_server
printf '\nWatch it grow: %s\n\n' "$url"
build/release/server/hermite-client stream "$sequence" --server "$url" --report build/demo-report.json >/dev/null
printf '\nThe scan is finished: %s\nIts report: build/demo-report.json\n' "$url"
[ -z "${DEMO_EXIT:-${CI:-}}" ] || exit 0
echo "The server runs until Ctrl-C."
trap 'exit 0' INT TERM
wait "$server"
