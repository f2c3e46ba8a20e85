# SPDX-License-Identifier: Apache-2.0
@0x87f3e99d7ecd69c9;

# What travels between a deployment process and the runtime of its robot; the C++ interface is DeploymentService.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "wire.capnp";
using Model = import "model.capnp";

# Timeouts are relative to the arrival of the call, in nanoseconds. Where `error` is there, nothing else counts. Lists of
# outcomes have one entry for each thing asked.
interface DeploymentProcess {
  info @0 () -> (error :Wire.Error, info :Info);
  snapshot @1 () -> (error :Wire.Error, snapshot :Snapshot);
  expect @2 (network :Model.Network) -> (error :Wire.Error);
  # What ends while others are still at work is reported to whoever follows, under `ticket`; the answer has all,
  # in their order.
  perform @3 (actions :List(Model.Action), timeout :Int64, ticket :UInt64)
      -> (error :Wire.Error, ended :List(Ended));
  conclude @4 (transition :Model.Transition) -> (error :Wire.Error);

  describe @5 (task :Text) -> (error :Wire.Error, model :Model.Component);
  properties @6 (task :Text) -> (answer :Wire.Answer);
  setProperty @7 (task :Text, path :Text, value :Wire.Value, timeout :Int64) -> (error :Wire.Error);
  call @8 (task :Text, operation :Text, arguments :Wire.Value, timeout :Int64) -> (answer :Wire.Answer);
  # `stream` only where the answer is not an error; the answer's value is the name of the port's type.
  openReader @9 (port :Model.PortRef, buffer :UInt32) -> (answer :Wire.Answer, stream :Wire.SampleStream);

  memory @10 () -> (error :Wire.Error, offer :Offer);
  admit @11 (offer :Offer) -> (error :Wire.Error);
  forget @12 (incarnation :UInt64) -> (error :Wire.Error);
  describeOutputs @13 (ports :List(Model.PortRef), timeout :Int64) -> (error :Wire.Error, origins :List(OriginOutcome));
  openInputs @14 (inputs :List(OpenInput), timeout :Int64) -> (error :Wire.Error, places :List(PlaceOutcome));
  attachOutputs @15 (outputs :List(AttachOutput), timeout :Int64) -> (error :Wire.Error, outcomes :List(Wire.Outcome));
  closeEndpoints @16 (endpoints :List(CloseEndpoint), timeout :Int64) -> (error :Wire.Error, outcomes :List(Wire.Outcome));

  # Until the connection ends. A client that does not keep up loses the oldest events.
  listen @17 (listener :TaskListener) -> (error :Wire.Error);
  # For all batches of this client from now on, until the connection ends; whoever was given last gets the reports.
  follow @18 (follower :BatchFollower) -> ();

  # No state: the task remembers nothing.
  saveState @19 (task :Text, timeout :Int64) -> (error :Wire.Error, state :State);
  restoreState @20 (task :Text, state :State, timeout :Int64) -> (error :Wire.Error);

  # `page` is the memory through which the runtime commits; the connections end with transition `number`.
  armCommit @21 (page :Memory, number :UInt64, within :List(Model.Connection), endpoints :List(EndingEndpoint))
      -> (error :Wire.Error);
  settle @22 () -> (error :Wire.Error);
}

interface BatchFollower {
  report @0 (ticket :UInt64, ended :List(Ended)) -> ();
}

struct Ended {
  index @0 :UInt32;  # of the action in its batch
  outcome @1 :Wire.Outcome;
  took @2 :Int64 = -1;  # nanoseconds, in the process; negative: not measured
}

interface TaskListener {
  report @0 (events :List(TaskEvent), lost :UInt64) -> ();
}

struct State {
  name @0 :Text;
  version @1 :UInt32;
  value @2 :Wire.Value;
}

# A capability that carries a file descriptor.
interface Memory {}

struct Offer {
  incarnation @0 :UInt64;
  payload @1 :Memory;
  control @2 :Memory;
}

struct TaskEvent {
  task @0 :Text;
  state @1 :UInt8;
  message @2 :Text;
}

struct Info {
  robot @0 :Text;
  deployment @1 :Model.Deployment;
  pid @2 :Int32;
  software @3 :Text;
  incarnation @4 :UInt64;
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

struct ConnectionReport {
  connection @0 :Model.Connection;
  written @1 :UInt64;
  read @2 :UInt64;
  dropped @3 :UInt64;
}

struct EndpointReport {
  connection @0 :Model.Connection;
  side @1 :UInt8;
  peer @2 :UInt64;
  place @3 :Place;
  written @4 :UInt64;
  read @5 :UInt64;
  dropped @6 :UInt64;
  overwritten @7 :UInt64;
  corrupt @8 :UInt64;
  damaged @9 :Bool;
  carries @10 :Bool = true;
}

struct MemoryUsage {
  payloadUsed @0 :UInt64;
  payloadTouched @1 :UInt64;
  controlUsed @2 :UInt64;
  connections @3 :UInt64;
  peers @4 :UInt64;
}

struct Snapshot {
  network @0 :Model.Network;
  tasks @1 :List(TaskReport);
  connections @2 :List(ConnectionReport);
  endpoints @3 :List(EndpointReport);
  memory @4 :MemoryUsage;
  hanging @5 :List(Text);
}

struct Origin {
  writer @0 :UInt64;
  sampleSize @1 :UInt64;
  flat @2 :Bool;
}

struct Place {
  reader @0 :UInt64;
  offset @1 :UInt64;
  generation @2 :UInt64;
  anyType @3 :Bool;
  type @4 :Text;
  hash @5 :UInt64;
  definition @6 :Text;
  port @7 :Text;
}

struct OriginOutcome {
  union {
    origin @0 :Origin;
    error @1 :Wire.Error;
  }
}

struct PlaceOutcome {
  union {
    place @0 :Place;
    error @1 :Wire.Error;
  }
}

# `atCommit`: the connection begins with the commit of the transition in progress.
struct OpenInput {
  connection @0 :Model.Connection;
  origin @1 :Origin;
  atCommit @2 :Bool;
}

struct AttachOutput {
  connection @0 :Model.Connection;
  place @1 :Place;
  atCommit @2 :Bool;
}

struct EndingEndpoint {
  connection @0 :Model.Connection;
  side @1 :UInt8;
  peer @2 :UInt64;
}

struct CloseEndpoint {
  connection @0 :Model.Connection;
  side @1 :UInt8;
  peerClosed @2 :Bool;
  peer @3 :UInt64;
}
