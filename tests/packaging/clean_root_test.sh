#!/usr/bin/env bash
# Installs Debian packages by apt in a Debian that has nothing but apt, so what they need must be what they declare; then goes through
# a newcomer's first hour there.
#   clean_root_test.sh PACKAGES FOLDER    PACKAGES: a folder with .deb files; FOLDER: for the root, several GB; it is emptied
# Exit status 77, with the reason, where this may not be done.
set -euo pipefail
cd "$(dirname "$0")/../.."
packages=$(realpath "${1:?the folder of the packages}")
folder=$(realpath -m "${2:?a folder for the root}")
root=$folder/root

skip() {
  echo "skipped: $*"
  exit 77
}

fail() {
  echo "failed: $*" >&2
  exit 1
}

# With processes, devices and /tmp of its own, so that all processes end and all mounts vanish with it.
inside() {
  unshare --mount --pid --fork -- bash -c '
    root=$1; shift
    mount -t proc proc "$root/proc" && mount --rbind /dev "$root/dev" && mount -t tmpfs tmpfs "$root/tmp" || exit
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
  ' bash "$root" "$@"
}

install() {
  inside apt-get install -q -y --no-install-recommends -o Dpkg::Options::=--force-unsafe-io "$@" > "$folder/apt.log" 2>&1 ||
    { tail -n 40 "$folder/apt.log"; return 1; }
}

# Libraries that programs and libraries of the packages do not find.
missing_libraries() {
  inside bash -c 'for file in $(dpkg -L segue segue-components | grep -E "^/usr/(bin/|lib/.*\.so)"); do
    [ ! -f "$file" ] || ldd "$file" 2> /dev/null | sed -n "s|^\s*\(.*\) => not found|$file needs \1|p"
  done'
}

command -v mmdebstrap > /dev/null || skip "mmdebstrap is not installed (tools/setup --packages)"
[ "$(id -u)" = 0 ] || skip "only root may make the root of a Debian and install there"
unshare --mount --pid --fork true 2> /dev/null || skip "the system permits no name spaces"
rm -rf "$folder"
mkdir -p "$folder"
. /etc/os-release
sources=()  # of this computer, as far as they are Debian's
for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
  [ ! -s "$file" ] || sources+=("$file")
done
mmdebstrap --variant=apt --dpkgopt=force-unsafe-io --skip=cleanup/apt/lists "${VERSION_CODENAME:?}" "$root" "${sources[@]}" > "$folder/debootstrap.log" 2>&1 || {
  tail -n 5 "$folder/debootstrap.log"
  skip "a Debian cannot be made here"
}
cp /etc/resolv.conf "$root/etc/" 2> /dev/null || true
trap 'rm -rf "$root"' EXIT

mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages/"
install $(cd "$packages" && printf '/packages/%s ' *.deb) || fail "apt does not install the packages"
missing=$(missing_libraries)
[ -z "$missing" ] || fail "$missing"
inside segue --version

# The hour needs a compiler, as its page says, and its script Python.
install cmake make g++ python3 || skip "no compiler can be installed here"
mkdir -p "$root/work/docs" "$root/work/tools" "$root/work/tests/system"
cp docs/first_component.md "$root/work/docs/"
cp tools/check_house tools/check_page "$root/work/tools/"
cp tests/system/newcomer_hour "$root/work/tests/system/"
inside /work/tests/system/newcomer_hour /usr
inside apt-get purge -q -y 'segue*' > "$folder/apt.log" 2>&1 || { cat "$folder/apt.log"; fail "the packages cannot be removed"; }
left=$(find "$root/usr" "$root/etc" -path '*segue*' -not -path '*/work/*')
[ -z "$left" ] || fail "left behind: $left"
echo "clean root: installed, a newcomer's hour, removed"
