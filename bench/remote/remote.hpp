// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../process/transport.hpp"

#include <array>
#include <string>

/// Transports from one host to another; here, from one process to another by way of the network.
namespace bench {

/// Where a process of the pair runs.
struct Place {
  std::string address = "127.0.0.1";
  std::string name_space{};  ///< of the network ("ip netns add"); empty: that of the benchmark
};

struct Route {
  Place writer{};
  Place reader{};
  /// Tells runs apart, since participants of earlier ones are remembered for some seconds.
  int run = 0;
};

/// Moves this process, which must have one thread, to the name space of the place. Ends the program on
/// failure.
void enter(const Place& place);

/// How samples are laid out in memory: without pointers, or with a vector inside.
enum class Layout { Fixed, Vector };

/// Writer -> gateway -> Cyclone DDS -> gateway -> reader, in four processes.
std::unique_ptr<Transport> make_remote_segue(const Route& route, Layout layout);

/// Cyclone DDS in two processes, with the gateway's configuration and quality of service. The reader waits in
/// a wait set, or is called in Cyclone's receive thread.
enum class CycloneReader { WaitSet, Listener };
std::unique_ptr<Transport> make_remote_cyclone(const Route& route, CycloneReader reader);

/// A TCP socket; the reader copies into one buffer.
std::unique_ptr<Transport> make_tcp(const Route& route);

}  // namespace bench
