// SPDX-License-Identifier: Apache-2.0
#include "wire/frame_queue.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace segue::wire {
namespace {

double share(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace

FrameQueue::FrameQueue(std::size_t stations, std::uint64_t seed)
    : stations_(stations), lines_(stations * stations) {
  // A direction's fate depends on nothing that is sent in other ones.
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    std::seed_seq numbers{seed, static_cast<std::uint64_t>(i)};
    lines_[i].random.seed(numbers);
  }
}

bool FrameQueue::later(const Due& left, const Due& right) {
  return std::tie(left.time, left.order) > std::tie(right.time, right.order);
}

void FrameQueue::send(std::size_t from, std::size_t to, std::span<const std::byte> frame, Time now) {
  const std::size_t index = from * stations_ + to;
  Line& line = lines_[index];
  ++line.count.sent;
  if (line.impairment.cut || share(line.random) < line.impairment.loss) {
    ++line.count.lost;
    return;
  }
  enqueue(index, frame, now);
  if (share(line.random) < line.impairment.duplication) {
    ++line.count.duplicated;
    enqueue(index, frame, now);
  }
}

void FrameQueue::enqueue(std::size_t index, std::span<const std::byte> frame, Time now) {
  Line& line = lines_[index];
  if (line.under_way == kCapacity) {
    ++line.count.overflowed;
    return;
  }
  const Impairment& impairment = line.impairment;
  Time takes = impairment.delay;
  takes += Time(static_cast<Time::rep>(static_cast<double>(impairment.jitter.count()) * share(line.random)));
  if (share(line.random) < impairment.reordering) {
    takes += impairment.held_back;
    ++line.count.held_back;
  }
  Due due{now + takes, sent_++, index, {}};
  if (!spare_.empty()) {
    due.frame = std::move(spare_.back());
    spare_.pop_back();
  }
  due.frame.assign(frame.begin(), frame.end());
  due_.push_back(std::move(due));
  std::push_heap(due_.begin(), due_.end(), later);
  ++line.under_way;
}

std::optional<Time> FrameQueue::next() const {
  if (due_.empty()) return std::nullopt;
  return due_.front().time;
}

std::optional<FrameQueue::Arrival> FrameQueue::receive(Time now) {
  if (due_.empty() || due_.front().time > now) return std::nullopt;
  std::pop_heap(due_.begin(), due_.end(), later);
  Due due = std::move(due_.back());
  due_.pop_back();
  Line& line = lines_[due.line];
  --line.under_way;
  ++line.count.delivered;
  return Arrival{due.line % stations_, std::move(due.frame)};
}

}  // namespace segue::wire
