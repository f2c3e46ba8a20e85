# SPDX-License-Identifier: Apache-2.0
@0xc560bd917c8e065d;

# What travels between a running robot and the programs that talk to it; the C++ interface is RobotService.
using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("segue::control::wire");

using Wire = import "/segue/rpc/wire.capnp";
using Tasks = import "tasks.capnp";

struct Sender {
  who @0 :Text;
  lease @1 :UInt64;
  besideMission @2 :Bool;
}

# Timeouts are relative to the arrival of the call, in nanoseconds.
struct RequestOptions {
  order @0 :Text;
  actionTimeout @1 :Int64;
  force @2 :Bool;
  who @3 :Text;
  # A list of {"task", "property", "value"}, or null.
  properties @4 :Wire.Value;
  lease @5 :UInt64;
  takeOver @6 :Bool;
}

interface Robot {
  status @0 () -> (answer :Wire.Answer);
  task @1 (id :Text) -> (answer :Wire.Answer);
  switchTo @2 (controller :Text, dryRun :Bool, timeout :Int64, options :RequestOptions) -> (answer :Wire.Answer);
  # `name` of one of the robot's, or else `text`.
  applyTransition @3 (text :Data, file :Text, timeout :Int64, name :Text, options :RequestOptions)
      -> (answer :Wire.Answer);
  resetBelief @4 (network :Data, file :Text) -> (answer :Wire.Answer);
  setProperty @5 (task :Text, property :Text, value :Wire.Value, timeout :Int64,
      sender :Sender) -> (answer :Wire.Answer);
  call @6 (task :Text, operation :Text, arguments :Wire.Value, timeout :Int64,
      sender :Sender) -> (answer :Wire.Answer);
  # `stream` only where the answer is not an error; the answer's value is the name of the port's type.
  openPort @7 (task :Text, port :Text, buffer :UInt32) -> (answer :Wire.Answer, stream :Wire.SampleStream);
  events @8 (after :UInt64, wait :Int64) -> (answer :Wire.Answer);
  history @9 () -> (answer :Wire.Answer);
  shutDown @10 () -> (answer :Wire.Answer);
  prepare @11 (controllers :List(Text), timeout :Int64, lease :UInt64) -> (answer :Wire.Answer);
  plan @12 (controller :Text, timeout :Int64, options :RequestOptions) -> (answer :Wire.Answer);
  applyFiles @13 (timeout :Int64, options :RequestOptions) -> (answer :Wire.Answer);
  switchToNetwork @14 (text :Data, file :Text, dryRun :Bool, timeout :Int64, options :RequestOptions)
      -> (answer :Wire.Answer);
  conflicts @15 (controllers :List(Text)) -> (answer :Wire.Answer);
  # `stream` only where the answer is not an error; the answer's value is the number of the lease. Reading from it waits for
  # nothing: it gives {"lost_to": NAME} once somebody has taken the robot over, {"stopped": true} once it commands nothing
  # any more, and {"asked": WHAT, "number", "arguments"} for each request of sendCommand.
  lease @16 (holder :Text) -> (answer :Wire.Answer, stream :Wire.SampleStream);
  write @17 (task :Text, port :Text, value :Wire.Value, timeout :Int64,
      sender :Sender) -> (answer :Wire.Answer);
  report @18 (lease :UInt64, doing :Wire.Value) -> (answer :Wire.Answer);
  # The answer's value is the number of the request.
  sendCommand @19 (what :Text, arguments :Wire.Value) -> (answer :Wire.Answer);
  mission @20 (after :UInt64, withPlan :Bool) -> (answer :Wire.Answer);
  past @22 (question :Wire.Value) -> (answer :Wire.Answer);
  cancel @21 (request :UInt64, who :Text, timeout :Int64) -> (answer :Wire.Answer);
  giveBack @23 (lease :UInt64, keep :Bool, timeout :Int64) -> (answer :Wire.Answer);
  stop @24 (who :Text, timeout :Int64) -> (answer :Wire.Answer);
  release @25 (who :Text) -> (answer :Wire.Answer);
  # As of TaskAccess; `changes` is the count of `changes` then.
  watch @26 (task :Text, seen :Tasks.TaskLevel, eachUpdate :Bool, timeout :Int64)
      -> (error :Wire.Error, level :Tasks.TaskLevel, changes :UInt64);
  running @27 (lease :UInt64) -> (answer :Wire.Answer);
  repair @28 (timeout :Int64, options :RequestOptions) -> (answer :Wire.Answer);
  # As of RobotService.
  changes @29 (seen :UInt64, timeout :Int64) -> (error :Wire.Error, count :UInt64);
  units @31 () -> (answer :Wire.Answer);
  # The answer's value is the count before.
  setUnits @32 (name :Text, count :UInt32, who :Text) -> (answer :Wire.Answer);
  takeInstance @30 (pool :Text, lost :Text, timeout :Int64, lostPid :Int32) -> (error :Wire.Error, task :Text, pid :Int32);
}
