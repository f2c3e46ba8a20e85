#!/usr/bin/env bash
# Runs a command with folders for sockets and state of its own, so that it meets no robot that runs beside it.
#   with_private_folders.sh COMMAND ARGUMENT...
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
XDG_RUNTIME_DIR="$folder" XDG_STATE_HOME="$folder/state" "$@"
