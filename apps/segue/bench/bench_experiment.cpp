// SPDX-License-Identifier: Apache-2.0
#include "bench_experiment.hpp"

#include <array>

namespace segue::cli {

namespace {

constexpr std::array<BenchExperiment, 5> kExperiments = {{
    {"E1.1", "latency of a chain with one relay, by the size of its samples",
     "Two hops, producer, relay, consumer; the time from writing to the consumer's update, of\n"
     "as many samples as come in 15 s, or fewer (--repetitions). With shm each task is in a\n"
     "process of its own; remote: the relay is on the other host. The floor: messages of that\n"
     "size, copied from pipe to pipe by as many bare threads or processes; for remote chains\n"
     "from TCP connection to TCP connection of this computer with itself.",
     "up to several kB < 1 ms in one process, small samples < 1 ms between processes, > 1 ms "
     "between two computers",
     "bytes", 200, run_latency_by_size},
    {"E1.2", "latency of a chain, by its number of relays",
     "As E1.1, with samples of 100 bytes. With shm each relay is in a process of its own, and\n"
     "both ends are in one; remote: every second relay, from the first on, is on the other\n"
     "host.",
     "for each relay 0.02 ms in one process, 0.14 ms between processes, 0.22 ms between two "
     "computers",
     "relays", 200, run_latency_by_length},
    {"E2.1", "bringing up a chain and taking it down",
     "The chains of E1.2: from the request until all tasks run, and from the request for the\n"
     "empty network until all tasks and processes are gone. The floor: as many bare threads\n"
     "started, or as many processes with the program `true` spawned and ended.",
     "25 tasks in one process some ms, in processes > 1 s, on two computers > 1.5 s", "relays", 5,
     run_bring_up},
    {"E2.2", "each kind of action",
     "Every action of bringing up a chain of one relay, calling an operation, recovering the\n"
     "relay from an error, and taking the chain down, as the runtime sees it, one action at a\n"
     "time (--order paper). Remote: all tasks are on the other host. The floor: for deploy a\n"
     "process with the program `true` spawned and ended, for other actions in another process\n"
     "a byte there and back through pipes, for those on another host by TCP. Round trip: the\n"
     "smallest request to the other host's daemon.",
     "a change of state 0.5 ms, on another computer 1.3 ms more; configure, deploy, undeploy "
     "tens of ms",
     "", 20, run_actions},
    {"E2.3", "exchange of half of the relays of a running chain, against a restart",
     "The second half of the relays is replaced by others of the same component, as in the\n"
     "paper, and every second one, so that every connection changes: the time of the switch,\n"
     "and the longest pause between two samples at the consumer. Remote: all relays are on the\n"
     "other host. Prepared: the other relays were configured ahead (segue prepare), and the\n"
     "old ones stay so. A restart is a switch to the empty network and one to the other chain.\n"
     "Samples come every millisecond.",
     "of up to 50 relays 320 ms at best (in one process), < 2 s at worst (on another computer)", "relays", 5,
     run_exchange},
}};

}  // namespace

std::span<const BenchExperiment> bench_experiments() {
  return kExperiments;
}

}  // namespace segue::cli
