#!/usr/bin/env bash
# A robot on two hosts of a real network: network name spaces for both hosts and for the runtime, joined by a bridge in a fourth one; daemons
# with certificates, reached over TCP. Switches, then cuts one host off, and then one direction between both.
#   robot_in_namespaces.sh SEGUE     the command
# Exit status 77, with the reason, where the system does not permit it.
set -euo pipefail

segue=$(realpath "${1:?the command segue}")
name=segue_r$$
hosts=(a b runtime)
folder=$(mktemp -d /tmp/segue_ns_XXXXXX)

skip() {
  echo "skipped: $*"
  exit 77
}

fail() {
  echo "failed: $*" >&2
  tail -n 30 "$folder"/*.log >&2
  exit 1
}

clean_up() {
  for space in "${hosts[@]}"; do
    ip netns pids "${name}_$space" 2>/dev/null | xargs -r kill -KILL 2>/dev/null || true
  done
  for space in "${hosts[@]}" net; do
    ip netns del "${name}_$space" 2>/dev/null || true  # its interfaces go with it
  done
  rm -rf "$folder"
}

make_spaces() {
  for space in "${hosts[@]}" net; do
    ip netns add "${name}_$space" 2>/dev/null || skip "no permission to make network name spaces"
    ip -n "${name}_$space" link set lo up
  done
  ip -n "${name}_net" link add bridge type bridge 2>/dev/null || skip "the kernel has no bridges"
  ip -n "${name}_net" link set bridge up
  local number=1
  for space in "${hosts[@]}"; do
    ip link add name eth netns "${name}_$space" type veth peer name "port_$space" netns "${name}_net" 2>/dev/null ||
      skip "the kernel has no pairs of interfaces (veth)"
    ip -n "${name}_net" link set "port_$space" master bridge up
    ip -n "${name}_$space" addr add "10.213.78.$number/24" dev eth
    ip -n "${name}_$space" link set eth up
    number=$((number + 1))
  done
}

# in_space SPACE COMMAND...: with the space's own folder for sockets.
in_space() {
  local space=$1
  shift
  XDG_RUNTIME_DIR="$folder/$space" ip netns exec "${name}_$space" "$@"
}

write_files() {
  mkdir "$folder/controllers"
  cat > "$folder/robot.yaml" <<'YAML'
robot: pair
hosts:
  a: {address: "tcp://10.213.78.1:7447", credentials: me}
  b: {address: "tcp://10.213.78.2:7447", credentials: me, optional: true}
libraries: [segue_components_bench]
controllers: [controllers/*.yaml]
YAML
  for relay in one two; do
    cat > "$folder/controllers/$relay.yaml" <<YAML
network: $relay
tasks:
  producer: {component: bench::Producer, activity: {periodic: 10ms}}
  relay_$relay: {component: bench::Relay}
  consumer: {component: bench::Consumer}
deployments:
  ends: {host: a, tasks: [producer, consumer]}
  middle: {host: b, tasks: [relay_$relay]}
connections:
  - {from: producer.out, to: relay_$relay.in, policy: buffer, size: 1000}
  - {from: relay_$relay.out, to: consumer.in, policy: buffer, size: 1000}
YAML
  done
}

status() { in_space runtime "$segue" status --format json 2>/dev/null; }

# wait_until WHAT EXPRESSION: of the status `s`, in Python.
wait_until() {
  for _ in $(seq 600); do
    if status | python3 -c "
import json, sys
s = json.load(sys.stdin)
hosts = {host['name']: host['reachable'] for host in s['hosts']}
tasks = {task['id']: task['state'] for task in s['tasks'] if not task['unknown']}
read = {c['from'] + ' ' + c['to']: c['read'] for c in s['connections']}
sys.exit(0 if $2 else 1)" 2>/dev/null; then
      echo "ok: $1"
      return
    fi
    sleep 0.1
  done
  status >&2 || true
  fail "$1"
}

# The chain through a relay carries samples.
wait_for_chain() {
  wait_until "samples pass through relay_$1" \
    "s['controller'] == '$1' and s['state'] == 'idle' and tasks == {'producer': 'running', 'relay_$1': 'running', 'consumer': 'running'} and read.get('relay_$1.out consumer.in', 0) > 20"
}

switch() { in_space runtime "$segue" switch "$1" > "$folder/switch.log" 2>&1; }

[ -x "$segue" ] || skip "$segue is not built"
command -v ip >/dev/null || skip "iproute2 is not installed (tools/setup --test)"
[ "$(id -u)" -eq 0 ] || skip "only root may make network name spaces"
trap clean_up EXIT
make_spaces
cd "$folder"
mkdir -m 700 "${hosts[@]}"
write_files
"$segue" host init --authority ca --no-host --out me > /dev/null
"$segue" host init --authority foreign --no-host --out stranger > /dev/null
for host in a b; do
  "$segue" host enrol "$host" --host --authority ca --out "keys_$host" > /dev/null
  in_space "$host" "$segue" host --name "$host" --state "$folder/$host/state" --listen 0.0.0.0 \
    --credentials "keys_$host" > "$folder/host_$host.log" 2>&1 &
done
for _ in $(seq 600); do
  in_space runtime "$segue" host list robot.yaml > list.log 2>&1 && break
  sleep 0.1
done
in_space runtime "$segue" host list robot.yaml || fail "the hosts cannot be reached"
sed 's/credentials: me/credentials: stranger/' robot.yaml > strange.yaml
if in_space runtime "$segue" host list strange.yaml > strange.log 2>&1; then
  fail "certificates of another authority were accepted"
fi
echo "ok: certificates of another authority are refused"

in_space runtime "$segue" run robot.yaml --controller one > run.log 2>&1 &
wait_for_chain one
switch two || fail "a switch"
wait_for_chain two

ip -n "${name}_net" link set port_b down
wait_until "a host that was cut off is unknown" "not hosts['b'] and hosts['a']"
switch one || fail "a switch without an optional host"
wait_until "the rest has switched" "s['controller'] == 'one' and tasks == {'producer': 'running', 'consumer': 'running'}"
ip -n "${name}_net" link set port_b up
wait_for_chain one

# Host a cannot send to host b any more; all else can be reached.
ip -n "${name}_a" route add blackhole 10.213.78.2/32
if switch two; then
  fail "a switch was done although samples cannot pass"
fi
grep -q "do not receive each other's samples" switch.log || fail "the message of that"
wait_until "it was undone" "s['controller'] == 'one' and tasks.get('relay_one') == 'running' and 'relay_two' not in tasks"
ip -n "${name}_a" route del blackhole 10.213.78.2/32
wait_for_chain one
switch two || fail "a switch after all is well again"
wait_for_chain two
echo "all ok"
