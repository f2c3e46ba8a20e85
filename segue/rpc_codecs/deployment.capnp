# SPDX-License-Identifier: Apache-2.0
@0x87f3e99d7ecd69c9;

# What travels between a deployment process and the runtime of its robot; the C++ interface is DeploymentService.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";
using Model = import "model.capnp";
using Tasks = import "tasks.capnp";

# Timeouts are relative to the arrival of the call, in nanoseconds. Where `error` is there, nothing else counts. Lists of
# outcomes have one entry for each thing asked.
interface DeploymentProcess extends(Tasks.TaskAccess) {
  info @0 () -> (error :Wire.Error, info :Info);
  snapshot @1 () -> (error :Wire.Error, snapshot :Snapshot);
  expect @2 (network :Model.Network) -> (error :Wire.Error);
  conclude @3 (transition :Model.Transition) -> (error :Wire.Error);

  memory @4 () -> (error :Wire.Error, offer :Offer);
  admit @5 (offer :Offer) -> (error :Wire.Error);
  forget @6 (incarnation :UInt64) -> (error :Wire.Error);
  describeOutputs @7 (ports :List(Model.PortRef), timeout :Int64) -> (error :Wire.Error, origins :List(OriginOutcome));
  openInputs @8 (inputs :List(OpenInput), timeout :Int64) -> (error :Wire.Error, places :List(PlaceOutcome));
  attachOutputs @9 (outputs :List(AttachOutput), timeout :Int64) -> (error :Wire.Error, outcomes :List(Wire.Outcome));
  closeEndpoints @10 (endpoints :List(CloseEndpoint), timeout :Int64) -> (error :Wire.Error, outcomes :List(Wire.Outcome));

  # Until the connection ends. A client that does not keep up loses the oldest events.
  listen @11 (listener :TaskListener) -> (error :Wire.Error);

  # `page` is the memory through which the runtime commits; the connections end with transition `number`.
  armCommit @12 (page :Memory, number :UInt64, within :List(Model.Connection), endpoints :List(EndingEndpoint))
      -> (error :Wire.Error);
  settle @13 () -> (error :Wire.Error);
}

interface TaskListener {
  report @0 (events :List(Tasks.TaskEvent), lost :UInt64) -> ();
}

# A capability that carries a file descriptor.
interface Memory {}

struct Offer {
  incarnation @0 :UInt64;
  payload @1 :Memory;
  control @2 :Memory;
}

struct Info {
  robot @0 :Text;
  deployment @1 :Model.Deployment;
  pid @2 :Int32;
  software @3 :Text;
  incarnation @4 :UInt64;
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
  damage @9 :UInt8;  # link::Damage
  carries @10 :Bool = true;
  latency @11 :Tasks.Latency;
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
  tasks @1 :List(Tasks.TaskReport);
  connections @2 :List(Tasks.ConnectionReport);
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
  topic @8 :Text;
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
