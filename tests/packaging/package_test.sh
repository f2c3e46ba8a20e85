#!/usr/bin/env bash
# Makes the Debian packages of a build and lets lintian look at them; then unpacks them into one folder, and goes
# through a newcomer's first hour with what is there: no program or library of the build is used.
#   package_test.sh BUILD_FOLDER FOLDER    FOLDER: for packages and what they hold; it is emptied
# Exit status 77, with the reason, where Debian's tools are missing.
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$(realpath "${1:?the build folder}")
packages=$(realpath -m "${2:?a folder for the packages}")

for tool in dpkg-deb dpkg-shlibdeps lintian; do
  command -v "$tool" > /dev/null || { echo "skipped: $tool is not installed (tools/setup --packages)"; exit 77; }
done

fail() {
  echo "failed: $*" >&2
  exit 1
}

check_completion() {
  local share=$1/usr/share
  bash -c ". $share/bash-completion/completions/segue && complete -p segue" > /dev/null || fail "no completion for bash"
  if command -v zsh > /dev/null; then
    zsh -f -n "$share/zsh/vendor-completions/_segue" || fail "no completion for zsh"
  fi
  if command -v fish > /dev/null; then
    fish --no-execute "$share/fish/vendor_completions.d/segue.fish" || fail "no completion for fish"
  fi
}

# A manual page for each program and each verb.
check_manual() {
  local pages=$1/usr/share/man/man1 verb
  for verb in $(segue --help | sed '1,/^Subcommands:/d' | sed -n 's/^  \([a-z][a-z-]*\) .*/\1/p'); do
    [ -s "$pages/segue-$verb.1.gz" ] || fail "no manual page of segue $verb"
  done
  for program in "$1"/usr/bin/*; do
    [ -s "$pages/$(basename "$program").1.gz" ] || fail "no manual page of $program"
  done
}

rm -rf "$packages"
SEGUE_MAINTAINER='no address' tools/package "$build" "$packages" > "$packages.log" 2>&1 && fail "a maintainer without an address is accepted"
grep -q 'write NAME <ADDRESS>' "$packages.log" || fail "it is not said how the maintainer is written"
SEGUE_MAINTAINER='Ada Lovelace <ada@example.org>' tools/package "$build" "$packages"
[ "$(dpkg-deb -f "$(ls "$packages"/segue_*.deb)" Maintainer)" = 'Ada Lovelace <ada@example.org>' ] || fail "the maintainer is not the one that was given"
lintian --allow-root --fail-on error,warning "$packages"/*.deb || fail "lintian has complaints"

root=$packages/root
for package in "$packages"/*.deb; do
  dpkg-deb -x "$package" "$root"
done
export PATH=$root/usr/bin:/usr/bin:/bin LD_LIBRARY_PATH=$root/usr/lib
[ "$(command -v segue)" = "$root/usr/bin/segue" ] || fail "the command is not that of the packages"
check_manual "$root"
check_completion "$root"
tests/system/newcomer_hour "$root/usr"
echo "packages: made, looked at by lintian, and used"
