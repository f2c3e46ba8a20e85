// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/wiring.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace segue::deploy::detail {

namespace {

using Indices = std::vector<std::size_t>;
using Groups = std::map<RecordPtr, Indices>;

/// What is known of one connection on its way.
struct Laying {
  const Crossing* crossing = nullptr;
  std::optional<Error> error;
  link::OutputOrigin origin;
  link::InputPlace place;
  bool opened = false;
  bool output_unsure = false;  ///< nobody knows whether its writer's endpoint stands

  [[nodiscard]] bool failed() const { return error.has_value(); }
  [[nodiscard]] bool whole() const { return crossing->writer != nullptr && crossing->reader != nullptr; }
};

/// One after the other, for each group in a thread of its own.
template <class Work>
void for_each_group(WorkerPool& pool, const Groups& groups, Work work) {
  std::vector<WorkerPool::Job> jobs;
  for (const auto& [record, indices] : groups) {
    jobs.emplace_back([&work, record = record, &indices = indices] { work(record, indices); });
  }
  pool.run_all(std::move(jobs));
}

/// As many answers as questions, whatever came.
template <class T>
std::vector<Result<T>> fitting(std::vector<Result<T>> answers, std::size_t count) {
  if (answers.size() != count) {
    answers.assign(count, fail(ErrorCode::Internal, "a process answered to another number of questions"));
  }
  return answers;
}

/// Asks one process about the things of `indices`; `make` gives a question, `take` gets its answer.
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

/// Whether an error leaves open what was done.
bool is_unsure(const Error& error) {
  return error.code == ErrorCode::Unavailable || error.code == ErrorCode::DeadlineExceeded ||
         error.code == ErrorCode::Internal;
}

/// The rounds of one batch.
class Batch {
 public:
  Batch(WorkerPool& pool, std::span<const Crossing> crossings, TimePoint deadline)
      : pool_(pool), deadline_(deadline) {
    for (const auto& crossing : crossings) {
      layings_.emplace_back().crossing = &crossing;
    }
  }

  std::vector<Result<void>> lay() {
    acquaint();
    describe();
    open();
    attach();
    undo();
    return outcomes();
  }

  /// Of a connection whose other end is gone, the endpoint here goes with the process there.
  std::vector<Result<void>> take_off() {
    close_outputs();
    close_inputs();
    return outcomes();
  }

 private:
  [[nodiscard]] Groups by_writer() const {
    Groups groups;
    for (std::size_t i = 0; i < layings_.size(); ++i) {
      if (!layings_[i].failed() && layings_[i].whole()) {
        groups[layings_[i].crossing->writer].push_back(i);
      }
    }
    return groups;
  }

  [[nodiscard]] Groups by_reader() const {
    Groups groups;
    for (std::size_t i = 0; i < layings_.size(); ++i) {
      if (!layings_[i].failed() && layings_[i].whole()) {
        groups[layings_[i].crossing->reader].push_back(i);
      }
    }
    return groups;
  }

  /// Both processes of every connection map each other's memory.
  void acquaint() {
    std::vector<Pair> pairs;
    for (const auto& laying : layings_) {
      pairs.emplace_back(laying.crossing->writer, laying.crossing->reader);
    }
    for (const auto& [pair, why] : detail::acquaint(pool_, pairs, deadline_)) {
      fail_between(pair, why);
    }
  }

  void fail_between(const Pair& pair, const Error& why) {
    const auto& [one, other] = pair;
    for (auto& laying : layings_) {
      const auto& [connection, writer, reader] = *laying.crossing;
      const bool between = (writer == one && reader == other) || (writer == other && reader == one);
      if (between && !laying.failed()) {
        laying.error = why;
      }
    }
  }

  void describe() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      ask<model::PortRef>(
          writer, indices, [&](std::size_t i) { return layings_[i].crossing->connection.from; },
          [&](DeploymentService& service, const std::vector<model::PortRef>& ports) {
            return service.describe_outputs(ports, deadline_);
          },
          [&](std::size_t i, Result<link::OutputOrigin> origin) {
            origin ? void(layings_[i].origin = *origin) : refuse(i, std::move(origin.error()));
          });
    });
  }

  void open() {
    for_each_group(pool_, by_reader(), [&](const RecordPtr& reader, const Indices& indices) {
      ask<OpenInput>(
          reader, indices,
          [&](std::size_t i) {
            return OpenInput{layings_[i].crossing->connection, layings_[i].origin};
          },
          [&](DeploymentService& service, const std::vector<OpenInput>& inputs) {
            return service.open_inputs(inputs, deadline_);
          },
          [&](std::size_t i, Result<link::InputPlace> place) {
            if (place) {
              layings_[i].place = std::move(*place);
            }
            // Where nobody knows, it is closed as if it were there.
            layings_[i].opened = place || is_unsure(place.error());
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
            return AttachOutput{layings_[i].crossing->connection, layings_[i].place};
          },
          [&](DeploymentService& service, const std::vector<AttachOutput>& outputs) {
            return service.attach_outputs(outputs, deadline_);
          },
          [&](std::size_t i, Result<void> attached) {
            if (!attached) {
              layings_[i].output_unsure = is_unsure(attached.error());
              refuse(i, std::move(attached.error()));
            }
          });
    });
  }

  /// Inputs that were opened in vain are closed; where the writer may have its endpoint after all, that one
  /// first. What cannot be reached now stays as an orphaned endpoint, for the next cleaning.
  void undo() {
    Groups outputs;
    for (std::size_t i = 0; i < layings_.size(); ++i) {
      if (layings_[i].output_unsure) {
        outputs[layings_[i].crossing->writer].push_back(i);
      }
    }
    for_each_group(pool_, outputs, [&](const RecordPtr& writer, const Indices& indices) {
      close(writer, indices, Side::Output, [&](std::size_t i, const Result<void>& closed) {
        layings_[i].output_unsure = !closed && closed.error().code != ErrorCode::NotFound;
      });
    });
    Groups inputs;
    for (std::size_t i = 0; i < layings_.size(); ++i) {
      if (layings_[i].failed() && layings_[i].opened && !layings_[i].output_unsure) {
        inputs[layings_[i].crossing->reader].push_back(i);
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
          const Crossing& crossing = *layings_[i].crossing;
          const RecordPtr& other = side == Side::Input ? crossing.writer : crossing.reader;
          return CloseEndpoint{crossing.connection, side, side == Side::Input, other->incarnation()};
        },
        [&](DeploymentService& service, const std::vector<CloseEndpoint>& endpoints) {
          return service.close_endpoints(endpoints, deadline_);
        },
        take);
  }

  void close_outputs() {
    for_each_group(pool_, by_writer(), [&](const RecordPtr& writer, const Indices& indices) {
      close(writer, indices, Side::Output, [&](std::size_t i, Result<void> closed) {
        layings_[i].opened = closed.has_value();  // here: one of its endpoints stood
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
        layings_[i].opened = layings_[i].opened || closed.has_value();
        if (!closed && !gone) {
          refuse(i, std::move(closed.error()));
        }
      });
    });
    for (auto& laying : layings_) {
      if (!laying.failed() && laying.whole() && !laying.opened) {
        laying.error = fail(ErrorCode::NotFound, "is not connected, so it cannot be disconnected",
                            to_string(laying.crossing->connection));
      }
    }
  }

  void refuse(std::size_t index, Error error) { layings_[index].error = std::move(error); }

  std::vector<Result<void>> outcomes() {
    std::vector<Result<void>> outcomes;
    for (auto& laying : layings_) {
      outcomes.push_back(laying.failed() ? Result<void>(std::move(*laying.error)) : Result<void>());
    }
    return outcomes;
  }

  WorkerPool& pool_;
  const TimePoint deadline_;
  std::vector<Laying> layings_;
};

bool is_of(const OrphanedEndpoint& endpoint, const Crossing& crossing) {
  const bool output = endpoint.side == Side::Output;
  const RecordPtr& own = output ? crossing.writer : crossing.reader;
  const RecordPtr& other = output ? crossing.reader : crossing.writer;
  return endpoint.connection == crossing.connection && endpoint.process == own->key() &&
         endpoint.peer == other->incarnation();
}

Error turn_taken() {
  return fail(ErrorCode::DeadlineExceeded, "connections made before are still being laid");
}

}  // namespace

Wiring::Turn::Turn(Wiring& wiring, TimePoint deadline) : wiring_(wiring) {
  std::unique_lock lock(wiring.mutex_);
  mine_ = wiring.changed_.wait_until(lock, deadline, [&] { return !wiring.taken_; });
  wiring.taken_ = wiring.taken_ || mine_;
}

Wiring::Turn::~Turn() {
  if (mine_) {
    const std::lock_guard lock(wiring_.mutex_);
    wiring_.taken_ = false;
    wiring_.changed_.notify_one();
  }
}

std::vector<Result<void>> Wiring::connect(std::span<const Crossing> crossings, TimePoint deadline) {
  const Turn turn(*this, deadline);
  if (!turn) {
    return {crossings.size(), turn_taken()};
  }
  auto outcomes = Batch(fleet_.pool(), crossings, deadline).lay();
  make_room(crossings, outcomes, deadline);
  std::vector<Crossing> again;
  Indices indices;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i] && outcomes[i].error().code == ErrorCode::AlreadyExists) {
      again.push_back(crossings[i]);
      indices.push_back(i);
    }
  }
  if (!again.empty()) {
    auto second = Batch(fleet_.pool(), again, deadline).lay();
    for (std::size_t i = 0; i < indices.size(); ++i) {
      outcomes[indices[i]] = std::move(second[i]);
    }
  }
  return outcomes;
}

/// One endpoint of a connection may be left over from a process that died while it was connected.
void Wiring::make_room(std::span<const Crossing> crossings, const std::vector<Result<void>>& outcomes,
                       TimePoint deadline) {
  std::vector<OrphanedEndpoint> orphaned;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i] || outcomes[i].error().code != ErrorCode::AlreadyExists) {
      continue;
    }
    if (orphaned.empty()) {
      orphaned = fleet_.merged_look().orphaned;
    }
    std::vector<OrphanedEndpoint> mine;
    std::copy_if(orphaned.begin(), orphaned.end(), std::back_inserter(mine),
                 [&](const OrphanedEndpoint& endpoint) { return is_of(endpoint, crossings[i]); });
    clean_now(mine, deadline);
  }
}

void Wiring::acquaint(const std::vector<Pair>& pairs, TimePoint deadline) {
  if (const Turn turn(*this, deadline); turn) {
    (void)detail::acquaint(fleet_.pool(), pairs, deadline);
  }
}

std::vector<Result<void>> Wiring::disconnect(std::span<const Crossing> crossings, TimePoint deadline) {
  const Turn turn(*this, deadline);
  if (!turn) {
    return {crossings.size(), turn_taken()};
  }
  return Batch(fleet_.pool(), crossings, deadline).take_off();
}

void Wiring::clean(TimePoint deadline) {
  const Turn turn(*this, deadline);
  if (turn) {
    clean_now(fleet_.merged_look().orphaned, deadline);
  }
}

void Wiring::clean_now(const std::vector<OrphanedEndpoint>& orphaned, TimePoint deadline) {
  std::map<model::DeploymentKey, std::vector<const OrphanedEndpoint*>> by_process;
  for (const auto& endpoint : orphaned) {
    by_process[endpoint.process].push_back(&endpoint);
  }
  std::vector<WorkerPool::Job> jobs;
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
        record->unlearn(incarnation);
      }
      if (!close.empty()) {
        (void)service->close_endpoints(close, deadline);  // what fails is seen by the next look
      }
    });
  }
  fleet_.pool().run_all(std::move(jobs));
}

}  // namespace segue::deploy::detail
