// SPDX-License-Identifier: Apache-2.0
#include <segue/type/made_vector.hpp>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>
#include <vector>

namespace segue::type::detail {

static_assert(sizeof(MadeVector) == sizeof(std::vector<int>));

namespace {

MadeVector& vector_at(void* object) {
  return *static_cast<MadeVector*>(object);
}
const MadeVector& vector_at(const void* object) {
  return *static_cast<const MadeVector*>(object);
}

const TypeInfo& item_of(const DescribedType& self) {
  return self.shape->element->info;
}

std::size_t bytes_of(const MadeVector& vector) {
  return static_cast<std::size_t>(vector.last - vector.first);
}

void release(MadeVector& vector) noexcept {
  ::operator delete(vector.first);
  vector = {};
}

void destroy_from(const TypeInfo& item, MadeVector& vector, std::byte* from) noexcept {
  while (vector.last != from) {
    vector.last -= item.size;
    item.destroy(vector.last);
  }
}

void append(const TypeInfo& item, MadeVector& vector, std::size_t bytes) {
  for (std::byte* const end = vector.first + bytes; vector.last != end; vector.last += item.size)
    item.construct(vector.last);
}

/// Items are copied, since they may refer to themselves (as libstdc++'s short texts do).
void reserve(const TypeInfo& item, MadeVector& vector, std::size_t bytes) {
  const auto capacity = static_cast<std::size_t>(vector.limit - vector.first);
  if (bytes <= capacity) return;
  const std::size_t grown = std::max(bytes, 2 * capacity);
  MadeVector larger;
  larger.first = larger.last = static_cast<std::byte*>(::operator new(grown));
  larger.limit = larger.first + grown;
  try {
    append(item, larger, bytes_of(vector));
    for (std::size_t offset = 0; offset < bytes_of(vector); offset += item.size)
      item.copy(larger.first + offset, vector.first + offset);
  } catch (...) {
    destroy_from(item, larger, larger.first);
    release(larger);
    throw;
  }
  std::swap(vector, larger);
  destroy_from(item, larger, larger.first);
  release(larger);
}

std::size_t size(const DescribedType& self, const void* object) {
  return bytes_of(vector_at(object)) / item_of(self).size;
}

const void* item(const DescribedType& self, const void* object, std::size_t index) {
  return vector_at(object).first + index * item_of(self).size;
}

void* reuse(const DescribedType& self, void* object, std::size_t count) {
  const TypeInfo& its_item = item_of(self);
  if (count > std::numeric_limits<std::ptrdiff_t>::max() / its_item.size) throw std::bad_alloc();
  MadeVector& vector = vector_at(object);
  const std::size_t bytes = count * its_item.size;
  if (bytes < bytes_of(vector)) {
    destroy_from(its_item, vector, vector.first + bytes);
  } else {
    reserve(its_item, vector, bytes);
    append(its_item, vector, bytes);
  }
  return vector.first;
}

void* resize(const DescribedType& self, void* object, std::size_t count) {
  destroy_from(item_of(self), vector_at(object), vector_at(object).first);
  return reuse(self, object, count);
}

}  // namespace

const SequenceAccess kMadeVectorAccess{&size, &item, &resize, &reuse};

void MadeVector::construct(const TypeInfo& /*self*/, void* memory) {
  ::new (memory) MadeVector;
}

void MadeVector::destroy(const TypeInfo& self, void* object) noexcept {
  MadeVector& vector = vector_at(object);
  destroy_from(item_of(*self.described), vector, vector.first);
  release(vector);
}

void MadeVector::copy(const TypeInfo& self, void* to, const void* from) {
  if (to == from) return;
  const TypeInfo& its_item = item_of(*self.described);
  const MadeVector& source = vector_at(from);
  std::byte* target = static_cast<std::byte*>(reuse(*self.described, to, bytes_of(source) / its_item.size));
  for (std::size_t offset = 0; offset < bytes_of(source); offset += its_item.size)
    its_item.copy(target + offset, source.first + offset);
}

}  // namespace segue::type::detail
