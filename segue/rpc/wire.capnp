# SPDX-License-Identifier: Apache-2.0
@0xf36ff93f31d9b9d7;

# What every service has in common: values, errors, samples, and the door. Only segue/control knows these files.
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

struct Outcome {
  union {
    done @0 :Void;
    error @1 :Error;
  }
}

# The door: what a connection reaches first. It never changes but by additions, so that any two versions can tell each
# other apart; hence the id, which does not depend on where it is written.
interface Bootstrap @0xc07a9d1168695c5c {
  # `wants` and `serves`: "robot", "deployment", "processes" or "host"; version 1 knew only robots and says nothing. `service`
  # (a Robot, Deployment or Processes) only where `error` is null.
  hello @0 (version :UInt32, software :Text, wants :Text)
      -> (version :UInt32, software :Text, error :Error, service :Capability, serves :Text);
}

interface SampleStream {
  read @0 (limit :UInt32) -> (answer :Answer);
  # Answers when there is a sample; with an empty list after the timeout, in nanoseconds.
  next @2 (limit :UInt32, timeout :Int64) -> (error :Error, samples :Value);
  # Answers when it has ended. What a client releases without this ends a little later.
  close @1 () -> (answer :Answer);
}
