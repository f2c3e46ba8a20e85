// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/policy.hpp>
#include <segue/base/result.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/sample_link/shared_memory.hpp>
#include <segue/task/port.hpp>

#include <cstdint>
#include <memory>
#include <string>

/// A connection between ports of two processes of one host: a ring in the reader's control pool. The reader's
/// endpoint is opened first, then the writer's is attached; they are closed in the reverse order.
namespace segue::sample_link {

/// Where the ring of a connection lies and which type the reader takes: all that the writer's process needs
/// to attach to it.
struct InputPlace {
  Incarnation reader = 0;
  std::uint64_t offset = 0;      ///< in the reader's control pool
  std::uint64_t generation = 0;  ///< tells this use of the place from earlier ones
  bool any_type = false;
  std::string type;        ///< name
  std::uint64_t hash = 0;  ///< structural_hash
  std::string definition;  ///< for the message where types do not match
  std::string port;        ///< "task.port"
  std::string topic{};     ///< PortOptions::topic
};

/// The writer's side of a connection, as the reader's process needs to know it before opening its endpoint.
struct OutputOrigin {
  Incarnation writer = 0;
  std::size_t sample_size = 0;  ///< sizeof its C++ type; 0 for a port of any type
  bool flat = false;            ///< samples are flattened (type/flat.hpp), else copied as bytes
};

/// Describes an output port for the process of the reader.
OutputOrigin describe_output(const SharedMemory& memory, const task::OutputPortBase& port);

/// The damage that was found in the memory of a connection.
enum class Damage : std::uint8_t {
  None,
  Ring,    ///< what the reader's process, the writer's, and other peers of the reader can write
  Payload  ///< a sample that is none of its type, in memory that only the writer's process can write
};

/// One endpoint of a connection between processes. disconnect() ends this endpoint alone. Both endpoints see
/// all counters, of which the writer keeps written, dropped and overwritten and the reader keeps read.
class SharedEndpoint : public PortConnection {
 public:
  [[nodiscard]] virtual Incarnation peer() const = 0;
  /// Samples dropped and entries ignored because the peer wrote invalid data. Always 0 unless the peer is
  /// broken or hostile.
  [[nodiscard]] virtual std::uint64_t corrupt() const = 0;
  /// Whether somebody overwrote what only the endpoints may write, so that samples are lost or do not flow
  /// any more: the connection must be made again. To be called about once a second, since what another thread
  /// or process may be changing just then counts only where it is wrong for two seconds. Where the reader was
  /// merely not woken, this wakes it.
  [[nodiscard]] virtual Damage damage(TimePoint now) = 0;
};

struct InputEndpoint {
  std::shared_ptr<SharedEndpoint> endpoint;
  InputPlace place;
};

/// Opens the reader's endpoint; samples arrive once the writer's is attached. Both endpoints get the gate, if
/// any. The writer's process must have been admitted. The place of the ring is reused only after the writer's
/// process has confirmed that its endpoint is closed (release_input) or is gone.
Result<InputEndpoint> open_input(SharedMemory& memory, const OutputOrigin& origin, task::InputPortBase& port,
                                 const Policy& policy, task::CommitGatePtr gate = nullptr);

/// Confirms that the writer's endpoint is closed or never existed, so the place of a disconnected reader's
/// endpoint may be reused.
void release_input(SharedMemory& memory, const InputPlace& place);

/// Attaches the writer's endpoint. TypeMismatch shows both definitions; AlreadyExists as connect(). The place
/// is untrusted and checked. With policy.init the last sample written is sent at once, or with a gate by
/// settle().
Result<std::shared_ptr<SharedEndpoint>> attach_output(SharedMemory& memory, const InputPlace& place,
                                                      task::OutputPortBase& port, const Policy& policy,
                                                      task::CommitGatePtr gate = nullptr);

}  // namespace segue::sample_link
