// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/connection_batch.hpp>

#include <segue/fleet/peer_mapping.hpp>

#include <map>
#include <optional>
#include <utility>

namespace segue::fleet::detail {

namespace {

using Indices = std::vector<std::size_t>;
using Groups = std::map<RecordPtr, Indices>;

/// The progress of one connection that is being made or ended.
struct ConnectAttempt {
  const RemoteConnection* remote = nullptr;
  std::optional<Error> error;
  Result<sample_link::OutputOrigin> origin = sample_link::OutputOrigin{};
  sample_link::InputPlace place;
  bool opened = false;              ///< the input may be open; when disconnecting: an endpoint existed
  bool output_unconfirmed = false;  ///< the writer may or may not have attached its endpoint

  [[nodiscard]] bool failed() const { return error.has_value(); }
  [[nodiscard]] bool has_both_processes() const {
    return remote->writer != nullptr && remote->reader != nullptr;
  }
};

using Jobs = std::vector<concurrent::ThreadPool::Job>;

/// Adds a job for each group, which calls work(process, indices).
template <class Work>
void add_jobs(Jobs& jobs, const Groups& groups, const Work& work) {
  for (const auto& [record, indices] : groups) {
    jobs.emplace_back([&work, record = record, &indices = indices] { work(record, indices); });
  }
}

/// Calls work(process, indices) for each group, all in parallel.
template <class Work>
void for_each_group(concurrent::ThreadPool& pool, const Groups& groups, const Work& work) {
  Jobs jobs;
  add_jobs(jobs, groups, work);
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
void ask(const RecordPtr& record, const Indices& indices, TimePoint deadline, Make make, Ask ask_service,
         Take take) {
  const ConnectionTurn turn(*record, deadline);
  const auto service = record->service();
  std::vector<Question> questions;
  questions.reserve(indices.size());
  for (const std::size_t index : indices) {
    questions.push_back(make(index));
  }
  using Answers = decltype(ask_service(*service, questions));
  Answers answers = !turn     ? Answers(indices.size(), turn.error())
                    : service ? fitting(ask_service(*service, questions), indices.size())
                              : Answers(indices.size(), record->unreachable());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    take(indices[i], std::move(answers[i]));
  }
}

/// The size of an output that is yet to be described: anything but 0, which stands for no type.
constexpr std::size_t kAnySize = 1;

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
    describe_and_open();
    open_again_without_type();
    attach();
    undo();
    return outcomes();
  }

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

  /// Describes outputs and opens inputs at the same time: nearly every output has a type, so inputs are
  /// opened for one that has. Only describe() writes the origins, and only open() the rest of an attempt.
  void describe_and_open() {
    for (auto& attempt : attempts_) {
      if (!attempt.failed() && attempt.has_both_processes()) {
        attempt.origin = sample_link::OutputOrigin{attempt.remote->writer->incarnation(), kAnySize, false};
      }
    }
    const Groups writers = by_writer();
    const Groups readers = by_reader();
    std::vector<Result<sample_link::OutputOrigin>> origins(attempts_.size());
    const auto describing = [&](const RecordPtr& writer, const Indices& indices) {
      describe(writer, indices, origins);
    };
    const auto opening = [&](const RecordPtr& reader, const Indices& indices) { open(reader, indices); };
    Jobs jobs;
    add_jobs(jobs, writers, describing);
    add_jobs(jobs, readers, opening);
    pool_.run_all(std::move(jobs));
    for (const auto& [writer, indices] : writers) {
      for (const std::size_t i : indices) {
        attempts_[i].origin = std::move(origins[i]);
        if (!attempts_[i].origin && !attempts_[i].failed()) {
          refuse(i, attempts_[i].origin.error());
        }
      }
    }
  }

  /// An input with a type reads from an output without one in another form.
  void open_again_without_type() {
    Groups readers;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
      const ConnectAttempt& attempt = attempts_[i];
      const bool ready = !attempt.failed() && attempt.has_both_processes();
      if (ready && attempt.origin->sample_size == 0 && !attempt.place.any_type) {
        readers[attempt.remote->reader].push_back(i);
      }
    }
    for_each_group(pool_, readers, [&](const RecordPtr& reader, const Indices& indices) {
      close(reader, indices, deploy::Side::Input, [](std::size_t, const Result<void>&) {});
      open(reader, indices);
    });
  }

  void describe(const RecordPtr& writer, const Indices& indices,
                std::vector<Result<sample_link::OutputOrigin>>& origins) {
    ask<model::PortRef>(
        writer, indices, deadline_, [&](std::size_t i) { return attempts_[i].remote->connection.from; },
        [&](deploy::DeploymentService& service, const std::vector<model::PortRef>& ports) {
          return service.describe_outputs(ports, deadline_);
        },
        [&](std::size_t i, Result<sample_link::OutputOrigin> origin) { origins[i] = std::move(origin); });
  }

  void open(const RecordPtr& reader, const Indices& indices) {
    ask<deploy::OpenInput>(
        reader, indices, deadline_,
        [&](std::size_t i) {
          return deploy::OpenInput{attempts_[i].remote->connection, *attempts_[i].origin,
                                   attempts_[i].remote->at_commit};
        },
        [&](deploy::DeploymentService& service, const std::vector<deploy::OpenInput>& inputs) {
          return service.open_inputs(inputs, deadline_);
        },
        [&](std::size_t i, Result<sample_link::InputPlace> place) {
          if (place) {
            attempts_[i].place = std::move(*place);
          }
          // Without a conclusive answer it is closed as if it had been opened.
          attempts_[i].opened = place || is_inconclusive(place.error());
          if (!place) {
            refuse(i, std::move(place.error()));
          }
        });
  }

  void attach() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      ask<deploy::AttachOutput>(
          writer, indices, deadline_,
          [&](std::size_t i) {
            return deploy::AttachOutput{attempts_[i].remote->connection, attempts_[i].place,
                                        attempts_[i].remote->at_commit};
          },
          [&](deploy::DeploymentService& service, const std::vector<deploy::AttachOutput>& outputs) {
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
      close(writer, indices, deploy::Side::Output, [&](std::size_t i, const Result<void>& closed) {
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
      close(reader, indices, deploy::Side::Input, [](std::size_t, const Result<void>&) {});
    });
  }

  template <class Take>
  void close(const RecordPtr& record, const Indices& indices, deploy::Side side, Take take) {
    ask<deploy::CloseEndpoint>(
        record, indices, deadline_,
        [&](std::size_t i) {
          const RemoteConnection& remote = *attempts_[i].remote;
          const RecordPtr& other = side == deploy::Side::Input ? remote.writer : remote.reader;
          return deploy::CloseEndpoint{remote.connection, side, side == deploy::Side::Input,
                                       other->incarnation()};
        },
        [&](deploy::DeploymentService& service, const std::vector<deploy::CloseEndpoint>& endpoints) {
          return service.close_endpoints(endpoints, deadline_);
        },
        take);
  }

  void close_outputs() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      close(writer, indices, deploy::Side::Output, [&](std::size_t i, Result<void> closed) {
        attempts_[i].opened = closed.has_value();
        if (!closed && closed.error().code != ErrorCode::NotFound && !writer->ended()) {
          refuse(i, std::move(closed.error()));
        }
      });
    });
  }

  void close_inputs() {
    for_each_group(pool_, by_reader(), [&](const RecordPtr& reader, const Indices& indices) {
      close(reader, indices, deploy::Side::Input, [&](std::size_t i, Result<void> closed) {
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

}  // namespace

std::vector<Result<void>> connect_all(concurrent::ThreadPool& pool,
                                      std::span<const RemoteConnection> connections, TimePoint deadline) {
  return ConnectionBatch(pool, connections, deadline).connect();
}

std::vector<Result<void>> disconnect_all(concurrent::ThreadPool& pool,
                                         std::span<const RemoteConnection> connections, TimePoint deadline) {
  return ConnectionBatch(pool, connections, deadline).disconnect();
}

}  // namespace segue::fleet::detail
