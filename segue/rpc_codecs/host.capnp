# SPDX-License-Identifier: Apache-2.0
@0xe5b1a3c08d5f7712;

# What travels between the daemon of a computer and the runtimes of robots; the C++ interfaces are HostService and
# HostedRobot.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";
using Model = import "model.capnp";
using Tasks = import "tasks.capnp";

# Timeouts are relative to the arrival of the call, in nanoseconds. Where `error` is there, nothing else counts.
interface Host {
  info @0 () -> (error :Wire.Error, info :HostInfo);
  clock @1 () -> (error :Wire.Error, time :Int64);  # nanoseconds since 1970, UTC
  robots @2 () -> (error :Wire.Error, robots :List(Lease));
  # `launch` as in Processes.start. The robot is given up when it is not renewed, not when the connection ends.
  # Whose `secret` and certificate are those of the present lease gets it anew.
  acquire @3 (holder :Text, launch :Wire.Value, models :List(ModelFile), takeOver :Bool, timeout :Int64,
      secret :Text, again :Bool, term :UInt64)
      -> (error :Wire.Error, robot :HostedRobot);
  # `after` instead of `lines` where it is there.
  log @4 (robot :Text, process :Text, lines :UInt64, after :LogPosition)
      -> (error :Wire.Error, text :Data, end :LogPosition);
  highestTerm @5 (robot :Text) -> (error :Wire.Error, term :UInt64);
}

struct LogPosition {
  file @0 :UInt64;
  offset @1 :UInt64;
}

# Networks and transitions hold the part of this host.
interface HostedRobot extends(Tasks.TaskAccess) {
  renew @0 () -> (error :Wire.Error);
  release @1 () -> (error :Wire.Error);
  snapshot @2 () -> (error :Wire.Error, view :View);
  expect @3 (target :Model.Network) -> (error :Wire.Error);
  beginTransition @4 (before :Model.Network, target :Model.Network) -> (error :Wire.Error);
  getReady @5 (target :Model.Network, links :List(LinkWait), timeout :Int64) -> (error :Wire.Error);
  armCommit @6 (transition :Model.Transition, number :UInt64, timeout :Int64) -> (error :Wire.Error);
  vote @7 (number :UInt64, validity :Int64) -> (error :Wire.Error);
  commit @8 (number :UInt64) -> (error :Wire.Error);
  conclude @9 (transition :Model.Transition) -> (error :Wire.Error);
  withdraw @10 () -> (error :Wire.Error);
  endProcesses @11 (timeout :Int64) -> (error :Wire.Error);
  # Until the connection ends. A client that does not keep up loses the oldest events.
  listen @12 (listener :HostListener) -> (error :Wire.Error);
  # In their partial order, after what beginTransition() does; each has `timeout`. Reports and answer as those of
  # TaskAccess.perform.
  performInOrder @13 (actions :List(Model.Action), timeout :Int64, ticket :UInt64)
      -> (error :Wire.Error, ended :List(Tasks.Ended));
  # Nothing more of what performInOrder() has been given begins.
  beginNoMore @14 () -> ();
}

struct LinkWait {
  task @0 :Text;
  count @1 :UInt32;
}

interface HostListener {
  report @0 (events :List(HostEvent), lost :UInt64) -> ();
}

struct HostEvent {
  union {
    task @0 :Tasks.TaskEvent;
    process @1 :ProcessEvent;
  }
}

struct ProcessEvent {
  host @0 :Text;
  process @1 :Text;
  message @2 :Text;
  gone @3 :Bool;
}

struct HostInfo {
  name @0 :Text;
  software @1 :Text;
  architecture @2 :Text;
  pid @3 :Int32;
  libraries @4 :List(Library);
}

struct Library {
  name @0 :Text;
  digest @1 :Text;
  components @2 :List(Text);
}

struct Lease {
  robot @0 :Text;
  holder @1 :Text;
  epoch @2 :UInt64;
  left @3 :Int64;  # nanoseconds
}

struct ModelFile {
  name @0 :Text;
  text @1 :Data;
}

struct View {
  network @0 :Model.Network;
  tasks @1 :List(Tasks.TaskReport);
  connections @2 :List(Tasks.ConnectionReport);
}
