// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/component.hpp>
#include <segue/task/input_timeout.hpp>

#include <algorithm>
#include <utility>

namespace segue::task {

namespace {

/// Longer than any robot runs, and short enough to be added to every time.
constexpr std::chrono::hours kLongest{24 * 365 * 100};

std::string doc_of(const InputPortBase& input, std::string doc) {
  return doc.empty() ? "how long " + quote(input.name()) + " may go without a sample; 0: for ever"
                     : std::move(doc);
}

}  // namespace

InputTimeout::InputTimeout(InputPortBase& input, std::string property, std::chrono::milliseconds limit,
                           std::string doc)
    : input_(input),
      limit_(input.component(), std::move(property), limit,
             {.live = true, .doc = doc_of(input, std::move(doc))}) {
  input.component().timeouts_.push_back(this);
}

InputTimeout::~InputTimeout() {
  std::erase(input_.component().timeouts_, this);
}

[[gnu::hot]] bool InputTimeout::passed() const noexcept {
  const Duration most = limit();
  return most > Duration::zero() && age() >= most;
}

[[gnu::hot]] Duration InputTimeout::age() const noexcept {
  const TaskContext* task = input_.component().context();
  return task == nullptr || input_.samples_read() != counted_ ? Duration::zero() : task->now() - since_;
}

void InputTimeout::begin(TimePoint now) noexcept {
  since_ = noted_ = now;
  counted_ = input_.samples_read();
}

[[gnu::hot]] void InputTimeout::note_update(TimePoint begin, TimePoint end) noexcept {
  noted_ = begin;
  const std::uint64_t read = input_.samples_read();
  if (std::exchange(counted_, read) != read) since_ = end;
}

[[gnu::hot]] TimePoint InputTimeout::due() const noexcept {
  const Duration most = limit();
  const TimePoint passes = since_ + most;
  return most == Duration::zero() || passes <= noted_ ? detail::kNever : passes;
}

Duration InputTimeout::limit() const noexcept {
  return std::clamp<std::chrono::milliseconds>(*limit_, std::chrono::milliseconds(0), kLongest);
}

}  // namespace segue::task
