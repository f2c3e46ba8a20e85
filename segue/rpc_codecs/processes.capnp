# SPDX-License-Identifier: Apache-2.0
@0x8b62c4ac930e42f0;

# What travels between the process server of a computer and runtimes; the C++ interface is ProcessService.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";

# Timeouts are relative to the arrival of the call, in nanoseconds. Where `error` is there, nothing else counts.
interface Processes {
  start @0 (launch :Wire.Value, timeout :Int64) -> (error :Wire.Error, process :ProcessInfo);
  # `kill`: at once, without asking.
  stop @1 (robot :Text, host :Text, process :Text, timeout :Int64, kill :Bool)
      -> (error :Wire.Error, exit :ExitReason);
  processes @2 (robot :Text) -> (error :Wire.Error, processes :List(ProcessInfo));
  # Until the connection ends. A client that does not keep up loses the oldest events.
  listen @3 (listener :ProcessListener) -> (error :Wire.Error);
}

interface ProcessListener {
  report @0 (events :List(ProcessInfo), lost :UInt64) -> ();
}

struct ExitReason {
  status @0 :Int32;
  signal @1 :Int32;
  coreDumped @2 :Bool;
  known @3 :Bool;
  requested @4 :Bool;
  killed @5 :Bool;
}

struct ProcessInfo {
  robot @0 :Text;
  host @1 :Text;
  process @2 :Text;
  pid @3 :Int32;
  socket @4 :Text;
  log @5 :Text;
  adopted @6 :Bool;
  exit @7 :ExitReason;  # null: it runs
}
