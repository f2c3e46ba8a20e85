#!/usr/bin/env bash
# Samples between two hosts of the real network: two network name spaces, joined by a bridge in a third one, with a gateway process in each.
# Then the same over lines that lose, delay, reorder and duplicate packets.
#   hosts_in_namespaces.sh BENCH     the program remote_hop_bench, which notes where samples are lost
# Exit status 77, with the reason, where the system does not permit it; the part about bad lines is left out, which is said, where the
# kernel has no netem.
set -euo pipefail

bench=${1:?the program remote_hop_bench}
name=segue_$$
spaces=("${name}_a" "${name}_b" "${name}_net")
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
  local net=${spaces[2]}
  ip -n "$net" link add bridge type bridge 2>/dev/null || skip "the kernel has no bridges"
  ip -n "$net" link set bridge up
  for i in 0 1; do
    ip link add name eth netns "${spaces[$i]}" type veth peer name "port$i" netns "$net" 2>/dev/null ||
      skip "the kernel has no pairs of interfaces (veth)"
    ip -n "$net" link set "port$i" master bridge up
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

# Both directions get worse.
worsen() {
  for i in 0 1; do
    ip netns exec "${spaces[$i]}" tc qdisc replace dev eth root netem "$@" 2>/dev/null || return 1
  done
}

[ -x "$bench" ] || skip "$bench is not built"
command -v ip >/dev/null && command -v tc >/dev/null || skip "iproute2 is not installed (tools/setup --test)"
[ "$(id -u)" -eq 0 ] || skip "only root may make network name spaces"
trap clean_up EXIT
make_spaces
carry "a good line" "1 kB"
carry "a good line" "64 kB"
if ! worsen delay 1ms; then
  echo "left out: bad lines, since the kernel has no netem"
  exit 0
fi
carry "1 ms late" "1 kB"
worsen loss 2%
carry "2 % lost" "1 kB"
worsen duplicate 5%
carry "5 % twice" "1 kB"
worsen delay 2ms reorder 25% 50%
carry "a quarter out of order" "1 kB"
worsen delay 2ms 1ms loss 1% duplicate 1% reorder 5%
carry "all together" "1 kB"
