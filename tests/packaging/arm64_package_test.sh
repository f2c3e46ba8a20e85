#!/usr/bin/env bash
# Makes the Debian packages for arm64 (`make package-arm64`), looks at them, and unpacks them with what they declare to need, and
# nothing else, into an empty folder; then goes through a newcomer's first hour with the programs there, in QEMU.
#   arm64_package_test.sh FOLDER    FOLDER: for what the packages hold; it is emptied
# Exit status 77, with the reason, where this cannot be done.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1:?a folder}")
packages=$PWD/build/packages-arm64
root=$folder/root

skip() {
  echo "skipped: $*"
  exit 77
}

fail() {
  echo "failed: $*" >&2
  exit 1
}

# What a robot with this architecture executes.
programs() {
  find "$root"/usr/bin/segue* "$root"/usr/lib/libsegue* "$root"/usr/lib/segue -type f \( -perm -100 -o -name '*.so*' \)
}

# Libraries that the architecture's own loader does not find.
missing_libraries() {
  local file
  for file in $(programs); do
    qemu-aarch64-static -L "$root" -E LD_TRACE_LOADED_OBJECTS=1 "$root/lib/ld-linux-aarch64.so.1" "$file" |
      sed -n "s|^\s*\(.*\) => not found|$file needs \1|p"
  done
}

# What starts the command and the processes of robots in QEMU, under their names. (The computer's kernel may not know how.)
put_programs() {  # folder
  local program
  mkdir -p "$1"
  for program in segue segue-deployment; do
    printf '#!/bin/sh\nSEGUE_DEPLOYMENT=%s exec qemu-aarch64-static -L %s %s "$@"\n' "$1/segue-deployment" "$root" "$root/usr/bin/$program" > "$1/$program"
    chmod +x "$1/$program"
  done
}

missing=$(tools/setup --arm64 --list)
[ -z "$missing" ] || skip "these packages are missing (tools/setup --arm64): ${missing//$'\n'/ }"
rm -rf "$folder"
mkdir -p "$folder"
SEGUE_MAINTAINER='Ada Lovelace <ada@example.org>' make package-arm64
lintian --allow-root --fail-on error,warning "$packages"/*.deb || fail "lintian has complaints"
for package in "$packages"/*.deb; do
  architecture=$(dpkg-deb -f "$package" Architecture)
  case "$package" in
    */segue-examples_* | */segue-studio_*) [ "$architecture" = all ] ;;
    *) [ "$architecture" = arm64 ] ;;
  esac || fail "$package is for $architecture"
done

# From a repository of their own, so that apt decides what else they need.
cp "$packages"/*.deb "$folder/"
(cd "$folder" && dpkg-scanpackages --multiversion . > Packages 2> scan.log) || fail "$(cat "$folder/scan.log")"
names=$(sed -n 's/^Package: //p' "$folder/Packages" | paste -sd,)
tools/arm64_root "$root" "$names" "deb [trusted=yes] copy:$folder ./" || fail "apt does not find what the packages need"
for file in $(programs); do
  readelf -h "$file" | grep -q 'Machine: *AArch64' || fail "$file is not for arm64"
done
missing=$(missing_libraries)
[ -z "$missing" ] || fail "$missing"

put_programs "$folder/usr/bin"
tests/system/newcomer_hour "$folder/usr" --without-compiler
echo "packages for arm64: made, looked at by lintian, and used in QEMU"
