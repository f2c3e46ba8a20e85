// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/remote_connector.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace segue::deploy::detail {

namespace {

using Indices = std::vector<std::size_t>;
using Groups = std::map<RecordPtr, Indices>;

/// The progress of one connection that is being made or ended.
struct ConnectAttempt {
  const RemoteConnection* remote = nullptr;
  std::optional<Error> error;
  link::OutputOrigin origin;
  link::InputPlace place;
  bool opened = false;              ///< the input may be open; when disconnecting: an endpoint existed
  bool output_unconfirmed = false;  ///< the writer may or may not have attached its endpoint

  [[nodiscard]] bool failed() const { return error.has_value(); }
  [[nodiscard]] bool has_both_processes() const {
    return remote->writer != nullptr && remote->reader != nullptr;
  }
};

/// Calls work(process, indices) for each group, all in parallel.
template <class Work>
void for_each_group(concurrent::ThreadPool& pool, const Groups& groups, Work work) {
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& [record, indices] : groups) {
    jobs.emplace_back([&work, record = record, &indices = indices] { work(record, indices); });
  }
  pool.run_all(std::move(jobs));
}

/// Replaces answers of which there are too many or too few by errors: another process is not to be trusted.
template <class T>
std::vector<Result<T>> fitting(std::vector<Result<T>> answers, std::size_t count) {
  if (answers.size() != count) {
    answers.assign(count, fail(ErrorCode::Internal, "a process answered to another number of questions"));
  }
  return answers;
}

/// Sends one request for each of `indices` to a process, in one message. `make` gives the requests, `take`
/// gets the answers.
template <class Question, class Make, class Ask, class Take>
void ask(const RecordPtr& record, const Indices& indices, Make make, Ask ask_service, Take take) {
  const auto service = record->service();
  std::vector<Question> questions;
  questions.reserve(indices.size());
  for (const std::size_t index : indices) {
    questions.push_back(make(index));
  }
  using Answers = decltype(ask_service(*service, questions));
  Answers answers = service ? fitting(ask_service(*service, questions), indices.size())
                            : Answers(indices.size(), record->unreachable());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    take(indices[i], std::move(answers[i]));
  }
}

/// Whether the request may have been carried out in spite of the error.
bool is_inconclusive(const Error& error) {
  return error.code == ErrorCode::Unavailable || error.code == ErrorCode::DeadlineExceeded ||
         error.code == ErrorCode::Internal;
}

/// Connects or disconnects one batch in rounds of messages. A round runs in parallel over the processes, each
/// with its own attempts, so no lock is needed.
class ConnectionBatch {
 public:
  ConnectionBatch(concurrent::ThreadPool& pool, std::span<const RemoteConnection> connections,
                  TimePoint deadline)
      : pool_(pool), deadline_(deadline) {
    for (const auto& remote : connections) {
      attempts_.emplace_back().remote = &remote;
    }
  }

  std::vector<Result<void>> connect() {
    map_peers();
    describe();
    open();
    attach();
    undo();
    return outcomes();
  }

  /// A connection with only one process left needs no message: forget() ends it together with the other
  /// process.
  std::vector<Result<void>> disconnect() {
    close_outputs();
    close_inputs();
    return outcomes();
  }

 private:
  [[nodiscard]] Groups by_writer() const {
    Groups groups;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
      if (!attempts_[i].failed() && attempts_[i].has_both_processes()) {
        groups[attempts_[i].remote->writer].push_back(i);
      }
    }
    return groups;
  }

  [[nodiscard]] Groups by_reader() const {
    Groups groups;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
      if (!attempts_[i].failed() && attempts_[i].has_both_processes()) {
        groups[attempts_[i].remote->reader].push_back(i);
      }
    }
    return groups;
  }

  /// Both processes of every connection have to map each other's memory.
  void map_peers() {
    std::vector<ProcessPair> pairs;
    for (const auto& attempt : attempts_) {
      pairs.emplace_back(attempt.remote->writer, attempt.remote->reader);
    }
    for (const auto& [pair, why] : detail::map_peers(pool_, pairs, deadline_)) {
      fail_between(pair, why);
    }
  }

  void fail_between(const ProcessPair& pair, const Error& why) {
    const auto& [one, other] = pair;
    for (auto& attempt : attempts_) {
      const auto& [connection, writer, reader, at_commit] = *attempt.remote;
      const bool between = (writer == one && reader == other) || (writer == other && reader == one);
      if (between && !attempt.failed()) {
        attempt.error = why;
      }
    }
  }

  void describe() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      ask<model::PortRef>(
          writer, indices, [&](std::size_t i) { return attempts_[i].remote->connection.from; },
          [&](DeploymentService& service, const std::vector<model::PortRef>& ports) {
            return service.describe_outputs(ports, deadline_);
          },
          [&](std::size_t i, Result<link::OutputOrigin> origin) {
            origin ? void(attempts_[i].origin = *origin) : refuse(i, std::move(origin.error()));
          });
    });
  }

  void open() {
    for_each_group(pool_, by_reader(), [&](const RecordPtr& reader, const Indices& indices) {
      ask<OpenInput>(
          reader, indices,
          [&](std::size_t i) {
            return OpenInput{attempts_[i].remote->connection, attempts_[i].origin,
                             attempts_[i].remote->at_commit};
          },
          [&](DeploymentService& service, const std::vector<OpenInput>& inputs) {
            return service.open_inputs(inputs, deadline_);
          },
          [&](std::size_t i, Result<link::InputPlace> place) {
            if (place) {
              attempts_[i].place = std::move(*place);
            }
            // Without a conclusive answer it is closed as if it had been opened.
            attempts_[i].opened = place || is_inconclusive(place.error());
            if (!place) {
              refuse(i, std::move(place.error()));
            }
          });
    });
  }

  void attach() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      ask<AttachOutput>(
          writer, indices,
          [&](std::size_t i) {
            return AttachOutput{attempts_[i].remote->connection, attempts_[i].place,
                                attempts_[i].remote->at_commit};
          },
          [&](DeploymentService& service, const std::vector<AttachOutput>& outputs) {
            return service.attach_outputs(outputs, deadline_);
          },
          [&](std::size_t i, Result<void> attached) {
            if (!attached) {
              attempts_[i].output_unconfirmed = is_inconclusive(attached.error());
              refuse(i, std::move(attached.error()));
            }
          });
    });
  }

  /// Closes inputs whose connection failed, but only after the writer's endpoint is certainly gone. An
  /// endpoint that cannot be reached now remains as an orphan, for remove_orphaned().
  void undo() {
    Groups outputs;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
      if (attempts_[i].output_unconfirmed) {
        outputs[attempts_[i].remote->writer].push_back(i);
      }
    }
    for_each_group(pool_, outputs, [&](const RecordPtr& writer, const Indices& indices) {
      close(writer, indices, Side::Output, [&](std::size_t i, const Result<void>& closed) {
        attempts_[i].output_unconfirmed = !closed && closed.error().code != ErrorCode::NotFound;
      });
    });
    Groups inputs;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
      if (attempts_[i].failed() && attempts_[i].opened && !attempts_[i].output_unconfirmed) {
        inputs[attempts_[i].remote->reader].push_back(i);
      }
    }
    for_each_group(pool_, inputs, [&](const RecordPtr& reader, const Indices& indices) {
      close(reader, indices, Side::Input, [](std::size_t, const Result<void>&) {});
    });
  }

  template <class Take>
  void close(const RecordPtr& record, const Indices& indices, Side side, Take take) {
    ask<CloseEndpoint>(
        record, indices,
        [&](std::size_t i) {
          const RemoteConnection& remote = *attempts_[i].remote;
          const RecordPtr& other = side == Side::Input ? remote.writer : remote.reader;
          return CloseEndpoint{remote.connection, side, side == Side::Input, other->incarnation()};
        },
        [&](DeploymentService& service, const std::vector<CloseEndpoint>& endpoints) {
          return service.close_endpoints(endpoints, deadline_);
        },
        take);
  }

  void close_outputs() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      close(writer, indices, Side::Output, [&](std::size_t i, Result<void> closed) {
        attempts_[i].opened = closed.has_value();
        if (!closed && closed.error().code != ErrorCode::NotFound && !writer->ended()) {
          refuse(i, std::move(closed.error()));
        }
      });
    });
  }

  void close_inputs() {
    for_each_group(pool_, by_reader(), [&](const RecordPtr& reader, const Indices& indices) {
      close(reader, indices, Side::Input, [&](std::size_t i, Result<void> closed) {
        const bool gone = reader->ended() || (!closed && closed.error().code == ErrorCode::NotFound);
        attempts_[i].opened = attempts_[i].opened || closed.has_value();
        if (!closed && !gone) {
          refuse(i, std::move(closed.error()));
        }
      });
    });
    for (auto& attempt : attempts_) {
      if (!attempt.failed() && attempt.has_both_processes() && !attempt.opened) {
        attempt.error = fail(ErrorCode::NotFound, "is not connected, so it cannot be disconnected",
                             to_string(attempt.remote->connection));
      }
    }
  }

  void refuse(std::size_t index, Error error) { attempts_[index].error = std::move(error); }

  std::vector<Result<void>> outcomes() {
    std::vector<Result<void>> outcomes;
    for (auto& attempt : attempts_) {
      outcomes.push_back(attempt.failed() ? Result<void>(std::move(*attempt.error)) : Result<void>());
    }
    return outcomes;
  }

  concurrent::ThreadPool& pool_;
  const TimePoint deadline_;
  std::vector<ConnectAttempt> attempts_;
};

bool is_of(const OrphanedEndpoint& endpoint, const RemoteConnection& remote) {
  const bool output = endpoint.side == Side::Output;
  const RecordPtr& own = output ? remote.writer : remote.reader;
  const RecordPtr& other = output ? remote.reader : remote.writer;
  return endpoint.connection == remote.connection && endpoint.process == own->key() &&
         endpoint.peer == other->incarnation();
}

ConnectionClaims::Key key_of(const model::Connection& connection) {
  return {connection.from, connection.to};
}

std::vector<ConnectionClaims::Key> keys_of(std::span<const RemoteConnection> connections) {
  std::vector<ConnectionClaims::Key> keys;
  for (const auto& remote : connections) {
    keys.push_back(key_of(remote.connection));
  }
  return keys;
}

Error another_batch_runs() {
  return fail(ErrorCode::DeadlineExceeded, "the same connections are still being made or ended");
}

}  // namespace

std::vector<Result<void>> RemoteConnector::connect(std::span<const RemoteConnection> connections,
                                                   TimePoint deadline) {
  const ConnectionClaims::Claim claim(claims_, keys_of(connections), deadline);
  if (!claim) {
    return {connections.size(), another_batch_runs()};
  }
  add_waiting(connections);
  auto outcomes = ConnectionBatch(fleet_.pool(), connections, deadline).connect();
  remove_blocking_endpoints(connections, outcomes, deadline);
  std::vector<RemoteConnection> again;
  Indices indices;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i] && outcomes[i].error().code == ErrorCode::AlreadyExists) {
      again.push_back(connections[i]);
      indices.push_back(i);
    }
  }
  if (!again.empty()) {
    auto second = ConnectionBatch(fleet_.pool(), again, deadline).connect();
    for (std::size_t i = 0; i < indices.size(); ++i) {
      outcomes[indices[i]] = std::move(second[i]);
    }
  }
  return outcomes;
}

/// A process that died while it was connected may have left the endpoint of its peer behind.
void RemoteConnector::remove_blocking_endpoints(std::span<const RemoteConnection> connections,
                                                const std::vector<Result<void>>& outcomes,
                                                TimePoint deadline) {
  std::vector<OrphanedEndpoint> orphaned;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i] || outcomes[i].error().code != ErrorCode::AlreadyExists) {
      continue;
    }
    if (orphaned.empty()) {
      orphaned = fleet_.poll_merged().orphaned;
    }
    std::vector<OrphanedEndpoint> mine;
    std::copy_if(orphaned.begin(), orphaned.end(), std::back_inserter(mine),
                 [&](const OrphanedEndpoint& endpoint) { return is_of(endpoint, connections[i]); });
    close_orphaned(mine, deadline);
  }
}

void RemoteConnector::map_peers(const std::vector<ProcessPair>& pairs, TimePoint deadline) {
  (void)detail::map_peers(fleet_.pool(), pairs, deadline);
}

std::vector<Result<void>> RemoteConnector::disconnect(std::span<const RemoteConnection> connections,
                                                      TimePoint deadline) {
  const ConnectionClaims::Claim claim(claims_, keys_of(connections), deadline);
  if (!claim) {
    return {connections.size(), another_batch_runs()};
  }
  return ConnectionBatch(fleet_.pool(), connections, deadline).disconnect();
}

void RemoteConnector::add_waiting(std::span<const RemoteConnection> connections) {
  const std::lock_guard lock(mutex_);
  for (const auto& remote : connections) {
    if (remote.at_commit) {
      waiting_.insert_or_assign(key_of(remote.connection), remote);
    }
  }
}

std::set<ConnectionClaims::Key> RemoteConnector::in_transition() const {
  const std::lock_guard lock(mutex_);
  std::set<ConnectionClaims::Key> keys = ending_;
  for (const auto& [key, remote] : waiting_) {
    keys.insert(key);
  }
  return keys;
}

void RemoteConnector::will_end(const model::Connection& connection) {
  const std::lock_guard lock(mutex_);
  ending_.insert(key_of(connection));
}

void RemoteConnector::conclude() {
  const std::lock_guard lock(mutex_);
  ending_.clear();
}

RemoteConnector::Waiting RemoteConnector::take_waiting() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

void RemoteConnector::settle() {
  take_waiting();
}

void RemoteConnector::give_up(TimePoint deadline) {
  conclude();
  std::vector<RemoteConnection> connections;
  for (auto& [key, remote] : take_waiting()) {
    connections.push_back(std::move(remote));
  }
  if (!connections.empty()) {
    disconnect(connections, deadline);  // what cannot be reached now is an orphan later
  }
}

void RemoteConnector::remove_orphaned(TimePoint deadline) {
  const ConnectionClaims::Claim::Watch watch(claims_);
  const auto kept = in_transition();  // what is added after this is claimed, or carries samples
  MergedView merged = fleet_.poll_merged();
  auto& orphaned = merged.orphaned;
  for (const auto& damaged : merged.damaged) {
    log(LogLevel::Error, "deploy",
        to_string(damaged.connection) + " is ended: its shared memory was overwritten (" +
            std::to_string(damaged.corrupt) + " invalid entries)");
  }
  std::vector<ConnectionClaims::Key> keys;
  for (const auto& endpoint : orphaned) {
    keys.push_back(key_of(endpoint.connection));
  }
  const ConnectionClaims::Claim claim(claims_, std::move(keys), watch);
  // Also where the peer seems to be gone: one that was started and connected during the poll is not in its
  // list.
  std::erase_if(orphaned, [&](const OrphanedEndpoint& endpoint) {
    const auto key = key_of(endpoint.connection);
    return !claim.has(key) || kept.contains(key);
  });
  close_orphaned(orphaned, deadline);
}

void RemoteConnector::close_orphaned(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline) {
  std::map<model::DeploymentKey, std::vector<const OrphanedEndpoint*>> by_process;
  for (const auto& endpoint : orphaned) {
    by_process[endpoint.process].push_back(&endpoint);
  }
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& [key, endpoints] : by_process) {
    jobs.emplace_back([this, deadline, key = key, &endpoints = endpoints] {
      const auto record = fleet_.find(key);
      const auto service = record ? record->service() : nullptr;
      if (service == nullptr) {
        return;
      }
      std::set<link::Incarnation> dead;
      std::vector<CloseEndpoint> close;
      for (const OrphanedEndpoint* endpoint : endpoints) {
        endpoint->peer_gone ? void(dead.insert(endpoint->peer))
                            : close.push_back({endpoint->connection, endpoint->side,
                                               endpoint->side == Side::Input, endpoint->peer});
      }
      for (const auto incarnation : dead) {
        (void)service->forget(incarnation);
        record->mark_unmapped(incarnation);
      }
      if (!close.empty()) {
        (void)service->close_endpoints(close, deadline);  // what fails is seen by the next poll
      }
    });
  }
  fleet_.pool().run_all(std::move(jobs));
}

}  // namespace segue::deploy::detail
