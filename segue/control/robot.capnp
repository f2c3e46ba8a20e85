# SPDX-License-Identifier: Apache-2.0
@0xc560bd917c8e065d;

# What travels between a running robot and the programs that talk to it. Only segue/control knows this file; the C++
# interface is RobotService.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

struct Value {
  union {
    nothing @0 :Void;
    boolean @1 :Bool;
    integer @2 :Int64;
    unsigned @3 :UInt64;
    number @4 :Float64;
    text @5 :Data;  # any bytes, usually UTF-8
    list @6 :List(Value);
    integers @7 :List(Int64);  # a list of nothing else, packed
    numbers @8 :List(Float64);
    map @9 :List(Entry);
  }
  source @10 :Text;  # how a scalar was written ("1.10"); a text property takes this

  struct Entry {
    key @0 :Data;
    value @1 :Value;
  }
}

struct Error {
  code @0 :Text;  # "not-found"; what the reader does not know counts as internal
  message @1 :Data;
  file @2 :Data;
  line @3 :Int32;
  column @4 :Int32;
  subject @5 :Data;
  cause @6 :Error;
}

struct Answer {
  union {
    value @0 :Value;
    error @1 :Error;
  }
}

# The door: what a connection reaches first. It never changes, so that any two versions can tell each other apart.
interface Gate {
  # `robot` only where `error` is null.
  hello @0 (version :UInt32, software :Text) -> (version :UInt32, software :Text, error :Error, robot :Robot);
}

# Timeouts are relative to the arrival of the call, in nanoseconds.
interface Robot {
  status @0 () -> (answer :Answer);
  task @1 (id :Text) -> (answer :Answer);
  switchTo @2 (controller :Text, dryRun :Bool, order :Text, timeout :Int64) -> (answer :Answer);
  applyTransition @3 (text :Data, file :Text, timeout :Int64) -> (answer :Answer);
  resetBelief @4 () -> (answer :Answer);
  setProperty @5 (task :Text, property :Text, value :Value, timeout :Int64) -> (answer :Answer);
  call @6 (task :Text, operation :Text, arguments :Value, timeout :Int64) -> (answer :Answer);
  # `stream` only where the answer is not an error; the answer's value is the name of the port's type.
  openPort @7 (task :Text, port :Text, buffer :UInt32) -> (answer :Answer, stream :SampleStream);
  events @8 (after :UInt64, wait :Int64) -> (answer :Answer);
  history @9 () -> (answer :Answer);
  shutDown @10 () -> (answer :Answer);
}

interface SampleStream {
  read @0 (limit :UInt32) -> (answer :Answer);
}
