# shellcheck shell=bash
# Sourced by demo.sh and test.sh, from the root of the source tree: what has to be on the machine.
#
#   install_packages   the Debian packages of packages.txt that are missing
#   provide_node       a Node that Vite runs on, first in PATH
#   install_viewer     the viewer's npm packages, as package-lock.json names them

readonly kOldestNode=20.19.0
readonly kFetchedNode=22.22.3

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

node_is_new_enough() {
  [ "$(printf '%s\n' "$kOldestNode" "$(node --version | tr -d v)" | sort -V | head -1)" = "$kOldestNode" ]
}

install_packages() {
  local package missing=()
  for package in $(sed 's/#.*//' deploy/packages.txt); do
    # Node may have come from elsewhere than Debian, with its npm.
    case $package in nodejs | npm) if command -v node >/dev/null && command -v npm >/dev/null; then continue; fi ;; esac
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  as_root apt-get update -q
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# HERMITE_FETCH_NODE=1 fetches it even where a good one is installed.
provide_node() {
  local machine folder
  case $(uname -m) in
    x86_64) machine=x64 ;;
    aarch64) machine=arm64 ;;
    *) machine=$(uname -m) ;;
  esac
  if [ "${HERMITE_FETCH_NODE:-}" != 1 ] && node_is_new_enough; then return 0; fi
  folder=$PWD/build/node-$kFetchedNode
  if [ ! -x "$folder/node_modules/.bin/node" ]; then
    echo "Fetching Node $kFetchedNode: Vite needs at least $kOldestNode"
    mkdir -p "$folder"
    npm install --loglevel=error --no-audit --no-fund --no-save --prefix "$folder" "node-linux-$machine@$kFetchedNode" npm@10.9.4
    ln -sf "../node-linux-$machine/bin/node" "$folder/node_modules/.bin/node"
  fi
  export PATH=$folder/node_modules/.bin:$PATH
}

install_viewer() {
  local installed=web/node_modules/.package-lock.json
  if [ ! -e "$installed" ] || [ web/package-lock.json -nt "$installed" ]; then npm ci --prefix web --no-audit --no-fund; fi
}
