#!/usr/bin/env bash
# Tries the packages of deploy/packages.sh in a bare Debian 12 of their own: installs, scans, changes a setting, reinstalls, upgrades,
# removes, purges, and looks at what is left. Says what failed and exits non-zero. systemd does not run there: the command of the unit is
# run as its user. Needs root, debootstrap and the network; fetches about 150 MB, takes minutes.
#
#   deploy/try_packages.sh [PACKAGES] [FOLDER]     packages of this folder (build/packages), in a new system at FOLDER/root (build/try)
#   DEBIAN_MIRROR=...                              where Debian comes from (http://deb.debian.org/debian)
set -euo pipefail
cd "$(dirname "$0")/.."

packages=$(realpath "${1:-build/packages}")
folder=$(realpath -m "${2:-build/try}")
readonly packages folder root=$folder/root
# As the new system sees them.
server_package=/packages/$(basename "$packages"/hermite-server_*.deb)
client_package=/packages/$(basename "$packages"/hermite-client_*.deb)
readonly server_package client_package
readonly mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
# Not the default, which another server of this machine may have: the network is the machine's.
readonly kPort=18080
readonly kScan=synthetic:frames=10,width=320,height=240

# Mounts and processes of their own: whatever happens, none is left.
if [ -z "${TRY_PACKAGES_INSIDE:-}" ]; then
  exec env TRY_PACKAGES_INSIDE=1 unshare --mount --pid --fork --kill-child --propagation private "$0" "$packages" "$folder"
fi

failed=0
holds() {  # SENTENCE COMMAND...
  local sentence=$1
  shift
  if "$@"; then
    echo "ok      $sentence"
  else
    echo "FAILED  $sentence"
    failed=$((failed + 1))
  fi
}
is() { [ "$1" = "$2" ] || { echo "        it is \"$1\" instead of \"$2\""; return 1; }; }
says() { grep -q -i -E "$1" "$folder/last.log" || { tail -5 "$folder/last.log"; return 1; }; }
says_no() { ! grep -i -E "$1" "$folder/last.log"; }
not() { ! "$@"; }

inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
apt() { inside apt-get -q -y "$@" >"$folder/last.log" 2>&1; }
apt_or_end() { apt "$@" || { tail -30 "$folder/last.log" >&2; exit 1; }; }
state() { inside dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null || true; }
# Everything of this name or of this user, wherever it lies.
traces() {
  inside find / -xdev \( -path /proc -o -path /packages \) -prune -o \( -iname '*hermite*' -o -user hermite \) -print 2>/dev/null | sort
}

bare_system() {
  if [ ! -e "$folder/bare/etc/debian_version" ]; then
    rm -rf "$folder/bare"
    debootstrap --variant=minbase bookworm "$folder/bare.part" "$mirror" >"$folder/debootstrap.log"
    mv "$folder/bare.part" "$folder/bare"
  fi
  rm -rf --one-file-system "$root"
  cp -a "$folder/bare" "$root"
  mount -t proc proc "$root/proc"
  mkdir "$root/packages"
  cp "$packages"/*.deb "$root/packages/"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  printf 'deb %s bookworm main\ndeb %s bookworm-updates main\ndeb %s-security bookworm-security main\n' "$mirror" "$mirror" "$mirror" \
    >"$root/etc/apt/sources.list"
  apt_or_end update
}

# The unit's command as its user, with its environment and groups, without rights, until stop_server.
start_server() {
  local unit=$root/lib/systemd/system/hermite.service command user environment
  command=$(sed -n 's/^ExecStart=//p' "$unit")
  user=$(sed -n 's/^User=//p' "$unit")
  environment=$(sed -n 's/^Environment=//p' "$unit")
  inside install -d -o "$user" -g "$user" /var/cache/hermite
  # shellcheck disable=SC2086
  chroot "$root" setpriv --reuid "$user" --regid "$user" --groups video,render --no-new-privs --bounding-set=-all --inh-caps=-all \
    env -i PATH=/usr/bin:/bin $environment $command >"$folder/server.out" 2>"$folder/server.log" &
  server=$!
  for _ in $(seq 150); do
    [ ! -s "$folder/server.out" ] || return 0
    kill -0 "$server" 2>/dev/null || break
    sleep 0.2
  done
  tail -5 "$folder/server.log"
  return 1
}
stop_server() { kill "$server" && wait "$server"; }

# As somebody who has no rights here.
client() {
  chroot "$root" setpriv --reuid nobody --regid nogroup --clear-groups env -i PATH=/usr/bin:/bin HOME=/tmp hermite-client "$@" \
    >"$folder/last.log" 2>&1
}

try_installing() {
  apt_or_end install "$server_package" "$client_package"
  holds "both packages are installed" is "$(state hermite-server) $(state hermite-client)" "installed installed"
  holds "the service is enabled" test -L "$root/etc/systemd/system/multi-user.target.wants/hermite.service"
  holds "the data folder is the service's alone" is "$(inside stat -c '%U %G %a' /var/lib/hermite)" "hermite hermite 700"
  holds "its user cannot log in" is "$(inside getent passwd hermite | cut -d: -f7)" /usr/sbin/nologin
}

try_scanning() {
  # The port is a setting, and with it the settings are a changed conffile from here on.
  printf 'listen = "127.0.0.1:%d"\nadmin-listen = "off"\n' "$kPort" >>"$root/etc/hermite/serve.toml"
  settings=$(sha256sum <"$root/etc/hermite/serve.toml")
  holds "the server starts" start_server
  holds "the packaged client streams a scan" client stream "$kScan" --server "$(cat "$folder/server.out")"
  holds "all frames are tracked" says '"tracked_frames": *10'
  holds "the viewer is there" viewer_answers
  holds "the server ends" stop_server
  holds "the scan is on the disk" test -n "$(find "$root/var/lib/hermite/scans" -name cloud.ply)"
}
viewer_answers() {
  exec 3<>"/dev/tcp/127.0.0.1/$kPort"
  printf 'GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: close\r\n\r\n' "$kPort" >&3
  grep -q '<title>' <&3
}

try_reinstalling() {
  start_server
  holds "installing the same version again works while the server runs" apt install --reinstall "$server_package"
  holds "changed settings stay" is "$(sha256sum <"$root/etc/hermite/serve.toml")" "$settings"
  holds "and the server goes on" kill -0 "$server"
  stop_server
}

# The same with another version, and other settings in it than before.
try_upgrading() {
  local tree=$folder/newer
  rm -rf "$tree"
  dpkg-deb --raw-extract "$root$server_package" "$tree"
  sed -i 's/^Version: .*/&+newer/' "$tree/DEBIAN/control"
  echo '# A newer comment.' >>"$tree/etc/hermite/serve.toml"
  dpkg-deb --root-owner-group --build "$tree" "$root/packages/newer.deb" >/dev/null
  start_server
  holds "a newer version replaces it while the server runs" apt -o Dpkg::Options::=--force-confold install /packages/newer.deb
  holds "changed settings stay, the new ones lie beside them" test -e "$root/etc/hermite/serve.toml.dpkg-dist"
  holds "and are not changed" is "$(sha256sum <"$root/etc/hermite/serve.toml")" "$settings"
  stop_server
  holds "the older version can be had again" apt -o Dpkg::Options::=--force-confold install --allow-downgrades "$server_package"
}

try_removing() {
  local before
  before=$(find "$root/var/lib/hermite" | wc -l)
  start_server
  holds "removing works while the server runs" apt remove hermite-server
  stop_server || true
  holds "the program is gone" not test -e "$root/usr/bin/hermite"
  holds "the scans stay" test "$(find "$root/var/lib/hermite" | wc -l)" -ge "$before"
  holds "the settings stay" is "$(sha256sum <"$root/etc/hermite/serve.toml")" "$settings"
  apt_or_end install "$server_package"
  start_server
  holds "installed again, the server has the scan" client list --server "$(cat "$folder/server.out")"
  holds "with its title" says synthetic
  stop_server
}

try_purging() {
  inside dpkg --purge hermite-server hermite-client >"$folder/last.log" 2>&1
  holds "purging warns of nothing" says_no 'warn|error|not empty'
  holds "nothing of this name or user is left" is "$(traces)" ""
  holds "but the user, in case backups elsewhere are its files" inside sh -c 'getent passwd hermite >/dev/null'
}

try_users() {
  apt_or_end install "$server_package"
  holds "the user that a purge left is used again" is "$(state hermite-server)" installed
  inside dpkg --purge hermite-server >/dev/null 2>&1
  inside userdel hermite
  inside useradd --uid 1000 --create-home hermite
  holds "where somebody is called hermite, the package refuses" not apt install "$server_package"
  holds "and says why" says 'is another account here'
  holds "and unpacks nothing" is "$(state hermite-server)" not-installed
  holds "nor takes that account's files" test -d "$root/home/hermite"
}

mkdir -p "$folder"
bare_system
try_installing
try_scanning
try_reinstalling
try_upgrading
try_removing
try_purging
try_users
echo
[ "$failed" -eq 0 ] || { echo "$failed failed; the system is $root"; exit 1; }
echo "All hold. The system is $root"
