// SPDX-License-Identifier: Apache-2.0
#include "versioned_world.hpp"

#include <algorithm>

namespace segue::task_network {

namespace {

/// A permutation of all numbers in which each bit depends on all bits (the finalizer of splitmix64: Steele,
/// Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014).
std::uint64_t mixed(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15U;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9U;
  number = (number ^ (number >> 27)) * 0x94d049bb133111ebU;
  return number ^ (number >> 31);
}

}  // namespace

bool VersionedWorld::reaches(std::uint32_t number) const {
  return root_ && (std::uint64_t{number} >> (kBits * (depth_ + 1))) == 0;
}

std::uint64_t VersionedWorld::cell(FactId fact) const {
  const std::uint32_t number = index(fact);
  if (!reaches(number)) return 0;
  const Page* page = root_.get();
  for (unsigned level = depth_; level > 0; --level) {
    page = static_cast<const Inner*>(page)->children[(number >> (kBits * level)) % kWidth].get();
    if (page == nullptr) return 0;
  }
  return static_cast<const Leaf*>(page)->cells[number % kWidth];
}

std::uint64_t& VersionedWorld::writable_cell(FactId fact) {
  const std::uint32_t number = index(fact);
  if (!root_) root_ = make_cow<Leaf>();
  while (!reaches(number)) {
    auto above = make_cow<Inner>();
    above->children[0] = std::move(root_);
    root_ = std::move(above);
    ++depth_;
  }
  CowPtr<Page>* place = &root_;
  for (unsigned level = depth_; level > 0; --level) {
    if (!*place)
      *place = make_cow<Inner>();
    else if (!place->unique())
      *place = CowPtr<Inner>(new Inner(static_cast<const Inner&>(**place)));
    place = &static_cast<Inner&>(**place).children[(number >> (kBits * level)) % kWidth];
  }
  if (!*place)
    *place = make_cow<Leaf>();
  else if (!place->unique())
    *place = CowPtr<Leaf>(new Leaf(static_cast<const Leaf&>(**place)));
  return static_cast<Leaf&>(**place).cells[number % kWidth];
}

bool VersionedWorld::set(const Literal& literal) {
  if (holds(literal)) return false;
  writable_cell(literal.fact) = ++version_ << 1 | (literal.value ? 1U : 0U);
  history_ = mixed(history_ ^ (std::uint64_t{index(literal.fact)} << 1 | (literal.value ? 1U : 0U)));
  for (Attachment& attachment : attachments_) {
    if (!attachment.data.unique()) attachment.data = attachment.data->clone();
    attachment.data->changed(literal);
  }
  return true;
}

void VersionedWorld::attach(std::string name, CowPtr<UserData> data) {
  const auto found = std::ranges::find(attachments_, name, &Attachment::name);
  if (found != attachments_.end())
    found->data = std::move(data);
  else
    attachments_.push_back({std::move(name), std::move(data)});
}

const UserData* VersionedWorld::attached(std::string_view name) const {
  const auto found = std::ranges::find(attachments_, name, &Attachment::name);
  return found == attachments_.end() ? nullptr : found->data.get();
}

void VersionedWorld::collect(const Page* page, unsigned depth, std::uint32_t first,
                             std::vector<FactId>& facts) {
  if (page == nullptr) return;
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    if (depth > 0)
      collect(static_cast<const Inner*>(page)->children[i].get(), depth - 1, first + (i << (kBits * depth)),
              facts);
    else if ((static_cast<const Leaf*>(page)->cells[i] & 1U) != 0)
      facts.push_back(FactId{first + i});
  }
}

std::vector<FactId> VersionedWorld::facts() const {
  std::vector<FactId> facts;
  collect(root_.get(), depth_, 0, facts);
  return facts;
}

std::vector<std::string> VersionedWorld::texts(const FactTable& table) const {
  std::vector<std::string> texts;
  for (const FactId fact : facts())
    texts.push_back(table.text(fact));
  std::ranges::sort(texts);
  return texts;
}

bool VersionedWorld::same(const Page* a, const Page* b, unsigned depth) {
  if (a == b) return true;
  if (a == nullptr || b == nullptr) {
    std::vector<FactId> rest;
    collect(a == nullptr ? b : a, depth, 0, rest);
    return rest.empty();
  }
  for (std::size_t i = 0; i < kWidth; ++i) {
    if (depth == 0) {
      if (((static_cast<const Leaf*>(a)->cells[i] ^ static_cast<const Leaf*>(b)->cells[i]) & 1U) != 0)
        return false;
    } else if (!same(static_cast<const Inner*>(a)->children[i].get(),
                     static_cast<const Inner*>(b)->children[i].get(), depth - 1)) {
      return false;
    }
  }
  return true;
}

bool operator==(const VersionedWorld& a, const VersionedWorld& b) {
  if (a.depth_ != b.depth_ && a.root_ && b.root_) return a.facts() == b.facts();
  return VersionedWorld::same(a.root_.get(), b.root_.get(), std::max(a.depth_, b.depth_));
}

}  // namespace segue::task_network
