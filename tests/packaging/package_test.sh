#!/usr/bin/env bash
# Makes the Debian packages of a build and lets lintian look at them; then unpacks them into one folder, and starts a robot
# from there: no program or library of the build is used.
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

# What the robot prints first is waited for.
start_robot() {
  coproc robot { exec segue run robot.yaml --controller explore 2>&1; }
  local line
  read -r line <&"${robot[0]}" || fail "segue run ended"
  echo "$line"
  [[ "$line" == "robot rover runs"* ]] || fail "the robot did not start"
  exec {output}<&"${robot[0]}"  # descriptors of a coproc are not passed on
  cat <&"$output" > run.log &
}

# The first page of the manual, as far as it needs no compiler.
walk_through() {
  segue --version
  segue component list > components.log
  grep -q demo::Drive components.log || fail "the components are not found"
  segue init rover > init.log
  cd rover
  segue check robot.yaml
  start_robot
  segue status > status.log
  grep -q 'controller explore' status.log || { cat status.log; fail "segue status does not show the controller"; }
  segue switch go_to | tail -n 1
  segue status > status.log
  grep -q 'controller go_to' status.log || fail "the robot was not switched"
  kill -INT "$robot_PID"
  wait "$robot_PID" || fail "the robot did not end well"
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
tools/package "$build" "$packages"
lintian --allow-root --fail-on error,warning "$packages"/*.deb || fail "lintian has complaints"

work=$packages/work
root=$packages/root
mkdir -p "$work"
for package in "$packages"/*.deb; do
  dpkg-deb -x "$package" "$root"
done
export PATH=$root/usr/bin:/usr/bin:/bin LD_LIBRARY_PATH=$root/usr/lib
export XDG_RUNTIME_DIR=$(mktemp -d) XDG_STATE_HOME=$work/state
trap 'rm -rf "$XDG_RUNTIME_DIR"; [ -z "${robot_PID:-}" ] || kill -KILL "$robot_PID" 2> /dev/null || true' EXIT
[ "$(command -v segue)" = "$root/usr/bin/segue" ] || fail "the command is not that of the packages"
check_manual "$root"
check_completion "$root"
cd "$work"
walk_through
echo "packages: made, looked at by lintian, and run"
