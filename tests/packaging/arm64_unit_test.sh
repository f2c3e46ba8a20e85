#!/usr/bin/env bash
# Runs the unit tests in QEMU, cross-compiled for arm64 as the packages are, but for those that take long already without. Cases that
# QEMU cannot run are left out (not_in_qemu).
#   arm64_unit_test.sh
# Exit status 77, with the reason, where this cannot be done.
set -euo pipefail
cd "$(dirname "$0")/../.."
jobs=${JOBS:-$(nproc)}

missing=$(tools/setup --arm64 --list)
if [ -n "$missing" ]; then
  echo "skipped: these packages are missing (tools/setup --arm64): ${missing//$'\n'/ }"
  exit 77
fi
tools/arm64_root
cmake --preset arm64
cmake --build --preset arm64 --target unit_tests -j "$jobs"
ctest --test-dir build/arm64 -L unit -LE long --output-on-failure --no-tests=error -j "$jobs"
