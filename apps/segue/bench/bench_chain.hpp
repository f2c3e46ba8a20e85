// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>

#include <cstddef>
#include <optional>
#include <string>

/// The networks of `segue bench`: chains producer -> relay_1 -> ... -> relay_n -> consumer.
namespace segue::cli {

/// Where the tasks run, and with that what carries their samples.
enum class BenchTransport {
  Local,         ///< all tasks in this process, a thread each
  SharedMemory,  ///< a process for each relay
  Remote         ///< a process for each relay, and another host
};
std::string to_string(BenchTransport transport);  ///< "local", "shm", "remote"

/// Which tasks of a remote chain are on the other host.
enum class ChainPlacement {
  All,
  Relays,           ///< samples cross at the first and at the last hop
  EverySecondRelay  ///< from the first on: samples cross at each hop, but for the last one of an even number
};

/// Which processes the producer and the consumer are in.
enum class ChainEnds { OneProcess, OwnProcesses };

/// The relays of a chain that are other tasks than in the chain it is compared with.
enum class Exchange {
  None,
  SecondHalf,  ///< most connections are between tasks of the same kind
  EverySecond  ///< every connection changes
};

struct ChainOptions {
  std::size_t relays = 0;
  BenchTransport transport = BenchTransport::Local;
  Exchange exchange = Exchange::None;
  std::size_t bytes = 100;           ///< of payload
  std::size_t record = 0;            ///< number of latencies that the consumer keeps
  std::optional<Duration> period{};  ///< of the producer; nothing: 1 ms, 20 ms for long chains
  std::string host{};                ///< the other one of a remote chain
  ChainPlacement placement = ChainPlacement::EverySecondRelay;
  ChainEnds ends = ChainEnds::OneProcess;
};
model::Network relay_chain(const ChainOptions& options);

}  // namespace segue::cli
