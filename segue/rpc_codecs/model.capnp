# SPDX-License-Identifier: Apache-2.0
@0xf689f11a399f0d3b;

# Networks, actions and component models, field by field: they are checked where they are read, not validated as files.
# Enumerations are positions in the lists of names of the C++ enumerations; durations are nanoseconds.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";

struct Activity {
  trigger @0 :UInt8;
  scheduler @1 :UInt8;
  optional @2 :Bool;
  priority @3 :Int32;
  period @4 :Int64;
  cpus @5 :List(Int32);
  thread @6 :Text;
  updateDeadline @7 :Int64;
  spin @8 :Int64;
  triggers @9 :List(Text);
}

struct PortRef {
  task @0 :Text;
  port @1 :Text;
}

struct Connection {
  fromTask @0 :Text;
  fromPort @1 :Text;
  toTask @2 :Text;
  toPort @3 :Text;
  kind @4 :UInt8;
  transport @5 :UInt8;
  init @6 :Bool;
  size @7 :UInt64;
}

struct Task {
  id @0 :Text;
  component @1 :Text;
  state @2 :UInt8;
  configNames @3 :List(Text);
  properties @4 :Wire.Value;
  activity @5 :Activity;  # null: the component's
  exclusive @6 :List(Text);
  takesOver @7 :Text;  # null: nobody
  onFailure @8 :UInt8;  # 0: not given; else one more than the position
}

struct Number {
  value @0 :UInt64;
}

struct Limits {  # null: none
  memory @0 :Number;
  openFiles @1 :Number;
  cpuTime @2 :Number;
  core @3 :Number;
}

struct Pair {
  first @0 :Text;
  second @1 :Text;
}

struct Deployment {
  host @0 :Text;
  process @1 :Text;
  placements @2 :List(Pair);  # task, its name inside the process
  deployer @3 :Text;
  scheduler @4 :UInt8;
  optional @5 :Bool;
  priority @6 :Int32;
  cpus @7 :List(Int32);
  environment @8 :List(Pair);
  limits @9 :Limits;
  onFailure @10 :UInt8;  # as a task's
  libraries @11 :List(Text);
}

struct Network {
  name @0 :Text;
  tasks @1 :List(Task);
  deployments @2 :List(Deployment);
  connections @3 :List(Connection);
}

struct Action {
  id @0 :Int32;
  kind @1 :UInt8;
  phase @2 :UInt8;
  after @3 :List(Int32);
  union {  # as `kind` demands
    task @4 :Text;
    connection @5 :Connection;
    deployment @6 :Deployment;
    config @7 :Config;
    call @8 :Call;
    handOver @10 :HandOver;
  }
  kill @9 :Bool;  # the process of an undeploy, instead of shutting it down
  atOnce @11 :Bool;  # a connection, whatever the commit

  struct Config {
    definition @0 :Task;
    host @1 :Text;
    process @2 :Text;
    name @3 :Text;
  }

  struct HandOver {
    from @0 :Text;
    to @1 :Text;
  }

  struct Call {
    task @0 :Text;
    operation @1 :Text;
    arguments @2 :Wire.Value;
  }
}

struct Transition {
  from @0 :Text;
  to @1 :Text;
  order @2 :UInt8;
  actions @3 :List(Action);
  removes @4 :List(Text);
  redefines @5 :List(Task);
}

struct Component {
  name @0 :Text;
  doc @1 :Text;
  library @2 :Text;
  abstract @3 :Bool;
  incomplete @4 :Bool;
  ownActivity @5 :Bool;
  ports @6 :List(Port);
  properties @7 :List(Property);
  operations @8 :List(Operation);
  activity @9 :Activity;
  triggerPorts @10 :List(Text);
  nominalStates @11 :List(Text);
  errorStates @12 :List(Text);
  exclusive @13 :List(Text);
  parent @14 :Text;
  descriptors @15 :List(Text);

  struct Port {
    name @0 :Text;
    direction @1 :UInt8;
    dynamic @2 :Bool;
    pattern @3 :Bool;
    type @4 :Text;
    doc @5 :Text;
  }

  struct Property {
    name @0 :Text;
    type @1 :Text;
    default @2 :Wire.Value;
    live @3 :Bool;
    doc @4 :Text;
  }

  struct Operation {
    name @0 :Text;
    arguments @1 :List(Argument);
    result @2 :Text;
    callerThread @3 :Bool;
    doc @4 :Text;
  }

  struct Argument {
    name @0 :Text;
    type @1 :Text;
    doc @2 :Text;
  }
}
