#!/usr/bin/env bash
# Debian packages of what build/release and web/dist contain: hermite-server, hermite-client and hermite-dev. Has lintian look at them, and
# prints sizes and hashes. Programs that are not built yet are built first; after `deploy/test.sh web release` none are. The viewer is packed
# as it was built last.
#
#   deploy/packages.sh [FOLDER]            puts them there, by default into build/packages
#   DEBFULLNAME=..., DEBEMAIL=...          whom the packages name as their maintainer
#   SOURCE_DATE_EPOCH=...                  the time of all files in the packages, by default that of the last commit
#   PACKAGES_COMPRESSION=gzip              instead of xz: a quarter of the time, but packages of one and a half times the size
#   PACKAGES_LINTIAN=off                   does not ask lintian
#
# The same tree and the same time give the same bytes.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly packages=${1:-build/packages}
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
# CPack makes folders with the rights that the umask leaves, and they are the folders of the packages.
umask 022

if [ ! -e web/dist/index.html ]; then
  echo "The viewer is not built: npm --prefix web run build" >&2
  exit 1
fi
cmake --preset release >/dev/null
cmake --build --preset release --target packaged

version=$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")$/\1/p' build/release/CPackConfig.cmake)
latest=$(dpkg-parsechangelog --file deploy/debian/changelog --show-field Version)
if [ "$version" != "$latest" ]; then
  echo "The project has version $version, but the first entry of deploy/debian/changelog has $latest." >&2
  exit 1
fi

mkdir -p "$packages"
rm -f "$packages"/hermite-*.deb  # of another version
cpack --config build/release/CPackConfig.cmake -D "CPACK_DEBIAN_COMPRESSION_TYPE=${PACKAGES_COMPRESSION:-xz}" -B "$(realpath "$packages")" \
  >"$packages/cpack.log" 2>&1 || {
  cat "$packages/cpack.log" >&2
  exit 1
}
rm -rf "$packages/_CPack_Packages"

# Tags below warnings are advice that Debian's own packages do not always follow.
[ "${PACKAGES_LINTIAN:-on}" = off ] || lintian --allow-root --fail-on error,warning "$packages"/hermite-*.deb
cd "$packages"
for package in hermite-*.deb; do printf '%9d bytes  %s  %s\n' "$(stat -c %s "$package")" "$(sha256sum "$package" | cut -d' ' -f1)" "$package"; done
