// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/base/result.hpp>
#include <segue/link/connection.hpp>
#include <segue/link/shared_memory.hpp>
#include <segue/task/port.hpp>

#include <cstdint>
#include <memory>
#include <string>

/// A connection between ports of two processes of one host: a ring of the reader's control pool. The reader's
/// endpoint is made first, the writer's endpoint next; they are taken off the other way round.
namespace segue::link {

/// Where the ring of a connection lies, and what the reader takes: all that the writer's process needs to
/// know.
struct InputPlace {
  Incarnation reader = 0;
  std::uint64_t offset = 0;      ///< in the reader's control pool
  std::uint64_t generation = 0;  ///< of this use of that place
  bool any_type = false;
  std::string type;        ///< name
  std::uint64_t hash = 0;  ///< structural_hash
  std::string definition;  ///< for a message where it does not match
  std::string port;        ///< "task.port"
};

/// What the writer's endpoint tells the reader's side in advance.
struct OutputOrigin {
  Incarnation writer = 0;
  std::size_t sample_size = 0;  ///< of its C++ type; 0 for any type (blank samples)
  bool flat = false;            ///< samples travel in the flat layout (type/flat.hpp), else as they are
};

/// What the process of the writer says of an output port, for the reader's endpoint. NotFound is the
/// caller's.
OutputOrigin describe_output(const SharedMemory& memory, const task::OutputPortBase& port);

/// One endpoint of a connection. As Connection; disconnect() is of this endpoint alone. counters(): written,
/// dropped and overwritten are the writer's, read is the reader's; both endpoints see all of them.
class SharedEndpoint : public Connection {
 public:
  [[nodiscard]] virtual Incarnation peer() const = 0;
  /// Samples that were dropped, and entries left alone, since what the peer wrote made no sense. 0 always
  /// unless it is broken or hostile.
  [[nodiscard]] virtual std::uint64_t corrupt() const = 0;
};

struct InputEndpoint {
  std::shared_ptr<SharedEndpoint> endpoint;
  InputPlace place;
};

/// Makes the reader's endpoint; samples come once the writer's endpoint stands. The writer must have been
/// admitted. The ring's place is used again only when the writer's process has confirmed its end
/// (release_input) or is gone.
Result<InputEndpoint> open_input(SharedMemory& memory, const OutputOrigin& origin, task::InputPortBase& port,
                                 const Policy& policy);

/// Says that the writer's endpoint is gone, or never was: the place of a disconnected reader's endpoint is
/// free.
void release_input(SharedMemory& memory, const InputPlace& place);

/// Makes the writer's endpoint. TypeMismatch with both definitions; the place is untrusted and checked. With
/// policy.init the last sample written follows at once.
Result<std::shared_ptr<SharedEndpoint>> attach_output(SharedMemory& memory, const InputPlace& place,
                                                      task::OutputPortBase& port, const Policy& policy);

}  // namespace segue::link
