// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace segue::task {

/// Options of a port, fixed when it is made.
struct PortOptions {
  bool dynamic = false;  ///< created in on_configure, destroyed in on_cleanup
  std::string doc{};
  /// Outputs: keep the last sample, so that a connection with Policy::init can begin with it. Costs one slot.
  bool keep_last = true;
  /// For ports that pass samples on without looking at them: those of types with pointers inside are bytes in
  /// the flat layout (type/flat.hpp, SampleSlot::flat_size), not objects. An input may get objects all the
  /// same, from a port of its own process. Without effect on OutputPort and InputPort, whose samples are
  /// objects.
  bool flat = false;
  /// Outputs: called when a connection has begun with the commit of a transition, for who has kept samples
  /// until then (OutputPortBase::dormant()). Not in the thread of the writer: it must not wait for long,
  /// throw, or change connections.
  std::function<void()> on_commit{};
  /// Where its samples travel outside of Segue as well ("topic /scan of domain 0"); empty: nowhere. Two ports
  /// with the same are not connected, since the samples would come twice, or go round.
  std::string topic{};
};

}  // namespace segue::task
