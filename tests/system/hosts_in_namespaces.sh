#!/usr/bin/env bash
# Samples between two hosts of the real network: two network name spaces with a gateway process in each, over lines that are good, and that
# lose, delay, reorder and duplicate packets.
#   hosts_in_namespaces.sh BENCH WIRE     the programs remote_hop_bench, which notes where samples are lost, and impaired_wire
# Exit status 77, with the reason, where the system does not permit it.
set -euo pipefail

bench=${1:?the program remote_hop_bench}
wire=${2:?the program impaired_wire}
name=segue_$$
spaces=("${name}_a" "${name}_b")
addresses=(10.213.77.1 10.213.77.2)

skip() {
  echo "skipped: $*"
  exit 77
}

clean_up() {
  for space in "${spaces[@]}"; do
    ip netns del "$space" 2>/dev/null || true  # its interfaces go with it
  done
}

make_spaces() {
  for space in "${spaces[@]}"; do
    ip netns add "$space" 2>/dev/null || skip "no permission to make network name spaces"
    ip -n "$space" link set lo up
  done
  coproc network { exec "$wire" a="${spaces[0]}" b="${spaces[1]}"; }
  answers=${network[0]} commands=${network[1]}
  read -r answer <&"$answers" || skip "the network cannot be made"
  for i in 0 1; do
    ip -n "${spaces[$i]}" addr add "${addresses[$i]}/24" dev eth
    ip -n "${spaces[$i]}" link set eth up
  done
}

# Measures hops of samples of one size. Every transport of Segue must have carried all of them.
carry() {
  local title=$1 size=$2 report
  report=$("$bench" --writer "${spaces[0]}" "${addresses[0]}" --reader "${spaces[1]}" "${addresses[1]}" "$size")
  echo "== $title, $size"
  echo "$report"
  # Two experiments with two layouts each.
  local carried
  carried=$(grep '^ *segue,' <<<"$report" | grep -vc 'failed' || true)
  if [ "$carried" -ne 4 ]; then
    echo "samples were lost: $carried of 4 measurements of Segue are complete" >&2
    exit 1
  fi
}

# In both directions.
impair() {
  echo "clear $*" >&"$commands"
  read -r answer <&"$answers"
  [ "$answer" = ok ]
}

[ -x "$bench" ] || skip "$bench is not built"
[ -x "$wire" ] || skip "$wire is not built"
command -v ip >/dev/null || skip "iproute2 is not installed (tools/setup --test)"
[ "$(id -u)" -eq 0 ] || skip "only root may make network name spaces"
trap clean_up EXIT
make_spaces
carry "a good line" "1 kB"
carry "a good line" "64 kB"
impair delay 1ms
carry "1 ms late" "1 kB"
impair loss 2%
carry "2 % lost" "1 kB"
impair duplicate 5%
carry "5 % twice" "1 kB"
impair reorder 25% 2ms
carry "a quarter out of order" "1 kB"
impair delay 2ms jitter 1ms loss 1% duplicate 1% reorder 5% 2ms
carry "all together" "1 kB"
