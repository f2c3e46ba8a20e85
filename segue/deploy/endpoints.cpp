// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/endpoints.hpp>

#include <segue/base/text.hpp>

namespace segue::deploy::detail {

namespace {

Error no_memory() {
  return fail(ErrorCode::Unsupported,
              "this process shares no memory with others; connect tasks of one process only");
}

Error stranger(sample_link::Incarnation peer, const model::Connection& connection) {
  return fail(ErrorCode::InvalidState,
              "the process at the other end (" + std::to_string(peer) + ") has not been admitted",
              to_string(connection));
}

Error about(Error error, const model::Connection& connection) {
  if (error.subject.empty()) {
    error.subject = to_string(connection);
  }
  return error;
}

}  // namespace

Result<sample_link::MemoryOffer> Endpoints::offer() const {
  return memory_ == nullptr ? no_memory() : memory_->offer();
}

Result<void> Endpoints::admit(const sample_link::MemoryOffer& peer) {
  return memory_ == nullptr ? no_memory() : memory_->admit(peer);
}

Result<void> Endpoints::forget(sample_link::Incarnation peer) {
  if (memory_ == nullptr) {
    return {};
  }
  memory_->forget(peer);
  table_.take_of_peer(peer);
  return {};
}

Result<sample_link::OutputOrigin> Endpoints::describe(const model::PortRef& port, TimePoint deadline) {
  if (memory_ == nullptr) {
    return no_memory();
  }
  sample_link::OutputOrigin origin;
  auto described = host_.with_output(port, deadline, [&](task::OutputPortBase& output) -> Result<void> {
    origin = sample_link::describe_output(*memory_, output);
    return {};
  });
  if (!described) {
    return std::move(described.error());
  }
  return origin;
}

Result<sample_link::InputPlace> Endpoints::open(const OpenInput& input, TimePoint deadline) {
  if (memory_ == nullptr) {
    return about(no_memory(), input.connection);
  }
  if (!memory_->knows(input.origin.writer)) {
    return stranger(input.origin.writer, input.connection);
  }
  if (table_.find(input.connection, Side::Input, input.origin.writer)) {
    return fail(ErrorCode::AlreadyExists, "is already connected", to_string(input.connection));
  }
  Endpoint made{input.connection, Side::Input, {}, input.origin.writer, nullptr};
  auto opened =
      host_.with_input(input.connection.to, deadline, [&](task::InputPortBase& port) -> Result<void> {
        auto endpoint = sample_link::open_input(*memory_, input.origin, port, input.connection.policy,
                                                input.at_commit ? host_.gate() : nullptr);
        if (!endpoint) {
          return std::move(endpoint.error());
        }
        made.shared = std::move(endpoint->endpoint);
        made.place = endpoint->place;
        return {};
      });
  if (!opened) {
    return about(std::move(opened.error()), input.connection);
  }
  if (auto added = table_.add(made); !added) {
    made.shared->disconnect();
    release(made);
    return std::move(added.error());
  }
  return made.place;
}

Result<void> Endpoints::attach(const AttachOutput& output, TimePoint deadline) {
  const sample_link::Incarnation reader = output.place.reader;
  if (memory_ == nullptr) {
    return about(no_memory(), output.connection);
  }
  if (!memory_->knows(reader)) {
    return stranger(reader, output.connection);
  }
  if (const auto present = table_.find(output.connection, Side::Output, reader)) {
    const sample_link::InputPlace& place = present->place;
    if (place.offset == output.place.offset && place.generation == output.place.generation) {
      return fail(ErrorCode::AlreadyExists, "is already connected", to_string(output.connection));
    }
    present->shared->disconnect();  // the reader has opened a new place: nobody reads from the old one
  }
  Endpoint made{output.connection, Side::Output, output.place, reader, nullptr};
  auto attached =
      host_.with_output(output.connection.from, deadline, [&](task::OutputPortBase& port) -> Result<void> {
        auto endpoint = sample_link::attach_output(*memory_, output.place, port, output.connection.policy,
                                                   output.at_commit ? host_.gate() : nullptr);
        if (!endpoint) {
          return std::move(endpoint.error());
        }
        made.shared = std::move(*endpoint);
        return {};
      });
  if (!attached) {
    return about(std::move(attached.error()), output.connection);
  }
  auto added = table_.add(made);
  if (!added) {
    made.shared->disconnect();
  }
  return added;
}

Result<void> Endpoints::close(const CloseEndpoint& what, TimePoint deadline) {
  for (auto& endpoint : table_.take(what.connection, what.side, what.peer)) {
    host_.let_reader_finish(*endpoint.shared, what.connection.to.task, deadline);
    endpoint.shared->disconnect();
    if (what.side == Side::Output) {
      continue;
    }
    if (what.peer_closed) {
      release(endpoint);
    } else if (auto kept = table_.add(endpoint); !kept) {
      return kept;
    }
  }
  return {};
}

void Endpoints::end_at(const task::CommitGatePtr& gate, std::span<const ArmCommit::Endpoint> ending) {
  for (const auto& [connection, side, peer] : ending) {
    if (const auto endpoint = table_.find(connection, side, peer)) {
      endpoint->shared->end_at(gate);
    }
  }
}

void Endpoints::settle() {
  for (const auto& endpoint : table_.connected()) {
    endpoint.shared->settle();
  }
}

void Endpoints::close_all() {
  for (const auto& endpoint : table_.take_all()) {
    endpoint.shared->disconnect();
  }
}

std::vector<EndpointReport> Endpoints::reports() {
  std::vector<EndpointReport> reports;
  const TimePoint now = RealClock::instance().now();
  for (auto& endpoint : table_.connected()) {
    reports.push_back({std::move(endpoint.connection), endpoint.side, endpoint.peer,
                       std::move(endpoint.place), endpoint.shared->counters(), endpoint.shared->corrupt(),
                       endpoint.shared->damage(now), endpoint.shared->carries(), endpoint.shared->latency()});
  }
  return reports;
}

sample_link::MemoryUsage Endpoints::usage() const {
  return memory_ == nullptr ? sample_link::MemoryUsage{} : memory_->usage();
}

void Endpoints::release(const Endpoint& endpoint) {
  sample_link::release_input(*memory_, endpoint.place);
}

}  // namespace segue::deploy::detail
