// SPDX-License-Identifier: Apache-2.0
#include "bench_experiment.hpp"

namespace segue::cli {

const std::vector<BenchExperiment>& bench_experiments() {
  static const std::vector<BenchExperiment> all = {
      {"E1.1", "latency of a chain, by its length",
       "Samples of 64 bytes go from a producer through the relays to a consumer; the time from writing to\n"
       "the consumer's update. Remote: every second task is on the other host; with an even number of\n"
       "relays the last hop stays here. The floor: a message of 64 bytes, copied from pipe to pipe by as\n"
       "many bare threads or processes; for remote chains from TCP connection to TCP connection of this\n"
       "computer with itself.",
       "for each hop 20 us in one process, 140 us between processes, 220 us between two computers", "relays",
       200, run_latency_by_length},
      {"E1.2", "latency of a chain, by the size of its samples",
       "As E1.1 with one relay (two hops), which copies each sample. The floor copies messages of that size\n"
       "likewise.",
       "for each hop of a small sample as E1.1; none by size is known here", "bytes", 100,
       run_latency_by_size},
      {"E2.1", "bringing up a chain and taking it down",
       "From the request for the chain until all its tasks run, and from the request for the empty network\n"
       "until all tasks and processes are gone. Alternating: every second task is on the other host, all\n"
       "others are here. The floor: as many bare threads started, or as many processes with the program\n"
       "`true` spawned and ended. A chain of 25 relays has 27 tasks.",
       "25 tasks in one process some ms, in processes > 1 s, on two computers > 1.5 s", "relays", 5,
       run_bring_up},
      {"E2.2", "each kind of action",
       "Every action of bringing up a chain of one relay, calling an operation, recovering the relay from\n"
       "an error, and taking the chain down, as the runtime sees it, one action at a time (--order paper).\n"
       "The floor: for deploy a process with the program `true` spawned and ended, for other actions in\n"
       "another process a byte there and back through pipes, for those on another host by TCP. Round trip:\n"
       "the smallest request to the other host's daemon.",
       "a change of state 0.5 ms, on another computer 1.3 ms more; configure, deploy, undeploy tens of ms",
       "", 20, run_actions},
      {"E2.3", "exchange of half of the relays of a running chain, against a full restart",
       "Half of the relays are replaced by others: neighbours in the middle (the best case) or every second "
       "one\n"
       "(the worst); the time of the switch, and the longest pause between two samples at the consumer.\n"
       "Prepared: the other relays were configured ahead (segue prepare), and the old ones stay so. A\n"
       "restart takes everything down and brings up the other chain. Samples come every millisecond.",
       "of up to 50 tasks 320 ms at best, < 2 s at worst; which exchange that was, and where, is not known "
       "here",
       "relays", 5, run_exchange}};
  return all;
}

}  // namespace segue::cli
