# SPDX-License-Identifier: Apache-2.0
@0xd1c3ef0a5b7e4429;

# What can be done with tasks, whether they live in one process or on a whole host; the C++ interface is TaskAccess.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";
using Model = import "model.capnp";

# Timeouts are relative to the arrival of the call, in nanoseconds. Where `error` is there, nothing else counts.
interface TaskAccess {
  # What ends while others are still at work is reported to whoever follows, under `ticket`; the answer has all,
  # in their order.
  perform @0 (actions :List(Model.Action), timeout :Int64, ticket :UInt64)
      -> (error :Wire.Error, ended :List(Ended));
  # For all batches of this client from now on, until the connection ends; whoever was given last gets the reports.
  follow @1 (follower :BatchFollower) -> ();

  describe @2 (task :Text) -> (error :Wire.Error, model :Model.Component);
  properties @3 (task :Text) -> (answer :Wire.Answer);
  setProperty @4 (task :Text, path :Text, value :Wire.Value, timeout :Int64) -> (error :Wire.Error);
  call @5 (task :Text, operation :Text, arguments :Wire.Value, timeout :Int64) -> (answer :Wire.Answer);
  # `stream` only where the answer is not an error; the answer's value is the name of the port's type.
  openReader @6 (port :Model.PortRef, buffer :UInt32) -> (answer :Wire.Answer, stream :Wire.SampleStream);

  # No state: the task remembers nothing.
  saveState @7 (task :Text, timeout :Int64) -> (error :Wire.Error, state :State);
  restoreState @8 (task :Text, state :State, timeout :Int64) -> (error :Wire.Error);
  write @9 (port :Model.PortRef, value :Wire.Value, timeout :Int64) -> (error :Wire.Error);
  details @10 (task :Text) -> (error :Wire.Error, details :Details);
  # Answers once the task is in another state than `seen` says (null: at once), with `eachUpdate` also after an update.
  watch @11 (task :Text, seen :TaskLevel, eachUpdate :Bool, timeout :Int64) -> (error :Wire.Error, level :TaskLevel);
}

interface BatchFollower {
  report @0 (ticket :UInt64, ended :List(Ended)) -> ();
}

struct Ended {
  index @0 :UInt32;  # of the action in its batch
  outcome @1 :Wire.Outcome;
  took @2 :Int64 = -1;  # nanoseconds, in the process; negative: not measured
  # Of actions in their partial order: nanoseconds since the begin of all of them; negative: not known.
  begin @3 :Int64 = -1;
  end @4 :Int64 = -1;
  begun @5 :Bool = true;
}

struct State {
  name @0 :Text;
  version @1 :UInt32;
  value @2 :Wire.Value;
}

struct TaskEvent {
  task @0 :Text;
  state @1 :UInt8;
  message @2 :Text;
}

struct Timing {
  cycles @0 :UInt64;
  missed @1 :UInt64;
  last @2 :Int64;
  mean @3 :Int64;
  worst @4 :Int64;
  latencyMean @5 :Int64;
  latencyWorst @6 :Int64;
  jitter @7 :Int64;
  cpu @8 :Int64;
}

struct TaskLevel {
  state @0 :UInt8;
  stateName @1 :Text;
  updates @2 :UInt64;
}

struct TaskReport {
  id @0 :Text;
  component @1 :Text;
  host @2 :Text;
  process @3 :Text;
  pid @4 :Int32;
  state @5 :UInt8;
  standIn @6 :Bool;
  stateName @7 :Text;
  error @8 :Text;
  activity @9 :Model.Activity;
  timing @10 :Timing;
}

# Counts of bins one after the other (task::DurationHistogram), from the first that is not 0 to the last.
struct Histogram {
  first @0 :UInt16;
  counts @1 :List(UInt64);
}

# What is said of a task only where it is asked for.
struct Details {
  updates @0 :Histogram;
  latencies @1 :Histogram;
  log @2 :List(LogLine);
}

struct LogLine {
  number @0 :UInt64;
  time @1 :Int64;  # nanoseconds since 1970, by the clock of its host
  level @2 :UInt8;
  message @3 :Text;
}

# From the write of a sample to its read, in nanoseconds.
struct Latency {
  measured @0 :UInt64;
  mean @1 :Int64;
  worst @2 :Int64;
  p99 @3 :Int64;
}

struct ConnectionReport {
  connection @0 :Model.Connection;
  written @1 :UInt64;
  read @2 :UInt64;
  dropped @3 :UInt64;
  latency @4 :Latency;
  error @5 :Text;
}
