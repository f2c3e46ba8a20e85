// SPDX-License-Identifier: Apache-2.0
#include <segue/task/port_access.hpp>
#include <segue/task/sample_pool.hpp>

#include <utility>

namespace segue::task {

namespace {

Error out_of_memory(const OutputPortBase& port) {
  return fail(ErrorCode::ResourceExhausted,
              "the shared memory of this process has no room for the samples of " + port.full_name() +
                  "; connect with smaller buffers");
}

}  // namespace

Result<void> OutputPortAccess::attach(OutputPortBase& port, std::shared_ptr<WriterEnd> end,
                                      const std::string& reader, const CommitGatePtr& gate) {
  const Lock lock(port.attach_mutex_);
  std::size_t slots = OutputPortBase::kWriterSlots + end->capacity();
  for (const auto& other : port.ends_.snapshot()) {
    if (other->same_as(*end)) {
      return fail(ErrorCode::AlreadyExists, port.full_name() + " is already connected to " + reader +
                                                " with this policy; connect it once, or with another policy");
    }
    slots += other->capacity();
  }
  if (!port.pool_->reserve(slots)) return out_of_memory(port);
  port.ends_.add(std::move(end), gate);
  return {};
}

void OutputPortAccess::end_at(OutputPortBase& port, const WriterEnd& end, const CommitGatePtr& gate) {
  port.ends_.end_at(&end, gate);
}

void OutputPortAccess::settle(OutputPortBase& port) {
  port.ends_.settle();
}

void OutputPortAccess::detach(OutputPortBase& port, const WriterEnd& end) {
  port.ends_.remove(&end);
}

void OutputPortAccess::wait_until_written(OutputPortBase& port) {
  const Lock lock(port.attach_mutex_);
  port.ends_.wait_for_reader();
}

Result<void> OutputPortAccess::share(OutputPortBase& port, const std::shared_ptr<SampleMemory>& memory) {
  if (!port.pool_->share(memory)) return out_of_memory(port);
  return {};
}

void InputPortAccess::attach(InputPortBase& port, std::shared_ptr<ReaderEnd> end) {
  const Lock lock(port.listener_mutex_);
  end->set_listener(port.listener_.load(std::memory_order_relaxed));
  port.ends_.add(std::move(end));
}

void InputPortAccess::end_at(InputPortBase& port, const ReaderEnd& end, const CommitGatePtr& gate) {
  port.ends_.end_at(&end, gate);
}

void InputPortAccess::settle(InputPortBase& port) {
  port.ends_.settle();
}

void InputPortAccess::detach(InputPortBase& port, const ReaderEnd& end) {
  port.ends_.remove(&end);
}

void InputPortAccess::set_listener(InputPortBase& port, SampleListener* listener) {
  const Lock lock(port.listener_mutex_);
  port.listener_.store(listener, std::memory_order_seq_cst);  // N1: before the task checks for samples
  for (const auto& end : port.ends_.snapshot())
    end->set_listener(listener);
}

}  // namespace segue::task
