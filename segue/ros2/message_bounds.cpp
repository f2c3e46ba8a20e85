// SPDX-License-Identifier: Apache-2.0
//
// Goes through CDR (segue/type/cdr_object.hpp) by the definitions of its messages: numbers are at multiples
// of their own size, counted from the end of the header; a sequence is a count of four bytes and its items, a
// text the same with a final zero byte.
#include <segue/ros2/message_bounds.hpp>

#include <segue/ros2/interface_names.hpp>
#include <segue/ros2/message_type.hpp>

#include <algorithm>

namespace segue::ros2 {

namespace {

constexpr std::size_t kHeader = 4;

bool is_bounded(const FieldType& type) {
  return type.primitive == Primitive::BoundedString || type.multiplicity == Multiplicity::BoundedSequence;
}

bool is_text(const FieldType& type) {
  return type.primitive == Primitive::String || type.primitive == Primitive::BoundedString;
}

std::string too_many(std::uint64_t count, const std::string& units, const FieldType& type) {
  return ": " + std::to_string(count) + " " + units + ", but it is a " + to_string(type);
}

}  // namespace

/// One way through a message, up to the first bound that it does not keep. Each function is false there.
class MessageBounds::Walk {
 public:
  /// `why`: set to what is wrong; may be null.
  Walk(const MessageBounds& bounds, std::span<const std::byte> message, std::string* why)
      : bounds_(bounds), why_(why) {
    if (message.size() >= kHeader) {
      little_ = message[1] != std::byte{0};
      bytes_ = message.subspan(kHeader);
    }
  }

  bool message(std::size_t index) {
    return std::ranges::all_of(bounds_.messages_[index], [this](const Field& one) {
      if (field(one)) return true;
      if (why_ != nullptr) why_->insert(0, one.name);
      return false;
    });
  }

 private:
  bool field(const Field& field) {
    std::uint64_t count = field.type.multiplicity == Multiplicity::Single ? 1 : field.type.capacity;
    const bool is_sequence = field.type.multiplicity == Multiplicity::Sequence ||
                             field.type.multiplicity == Multiplicity::BoundedSequence;
    if (is_sequence && !read_count(count)) return false;
    if (field.type.multiplicity == Multiplicity::BoundedSequence && count > field.type.capacity)
      return refuse([&] { return too_many(count, "items", field.type); });
    if (field.number > 0) return numbers(count, field.number);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (field.nested ? nested(*field.nested) : text(field.type)) continue;
      if (why_ != nullptr && field.type.multiplicity != Multiplicity::Single)
        why_->insert(0, "[" + std::to_string(i) + "]");
      return false;
    }
    return true;
  }

  bool nested(std::size_t index) {
    if (message(index)) return true;
    if (why_ != nullptr) why_->insert(0, ".");
    return false;
  }

  /// Some writers give an empty text the length 0 instead of 1.
  bool text(const FieldType& type) {
    std::uint64_t size = 0;
    if (!read_count(size)) return false;
    if (type.primitive == Primitive::BoundedString && size > 0 && size - 1 > type.string_capacity)
      return refuse([&] { return too_many(size - 1, "bytes", type); });
    return skip(size);
  }

  bool numbers(std::uint64_t count, std::size_t size) {
    return count == 0 || (align(size) && skip(count * size));
  }

  bool read_count(std::uint64_t& count) {
    constexpr std::size_t kSize = 4;
    if (!align(kSize) || !skip(kSize)) return false;
    count = 0;
    for (std::size_t i = 0; i < kSize; ++i)
      count = count * 256 + std::to_integer<std::uint64_t>(bytes_[used_ - (little_ ? i + 1 : kSize - i)]);
    return true;
  }

  bool align(std::size_t size) { return skip((size - used_ % size) % size); }

  bool skip(std::uint64_t size) {
    if (size > bytes_.size() - used_) return refuse([] { return ": the message ends too early"; });
    used_ += size;
    return true;
  }

  template <class Text>
  bool refuse(const Text& text) {
    if (why_ != nullptr) *why_ = text();
    return false;
  }

  const MessageBounds& bounds_;
  std::string* why_;
  std::span<const std::byte> bytes_;
  std::size_t used_ = 0;
  bool little_ = true;
};

Result<MessageBounds> MessageBounds::of(InterfaceLibrary& library, std::string_view name) {
  type::TypeRegistry registry;
  if (const auto type = message_type(library, name, registry); !type) return type.error();
  const auto definitions = library.with_parts(name);
  if (!definitions) return definitions.error();
  MessageBounds bounds;
  for (const MessageDefinition* message : *definitions) {
    auto& fields = bounds.messages_.emplace_back();
    for (const FieldDefinition& definition : message->fields) {
      Field& field = fields.emplace_back(Field{definition.name, definition.type});
      bounds.any_ = bounds.any_ || is_bounded(field.type);
      if (field.type.primitive == Primitive::Nested) {
        const auto part = std::ranges::find(*definitions, field.type.nested, &MessageDefinition::name);
        field.nested = static_cast<std::size_t>(part - definitions->begin());
      } else if (!is_text(field.type)) {
        field.number = registry.find(port_type(field.type.primitive))->size;
      }
    }
  }
  return bounds;
}

bool MessageBounds::kept_by(std::span<const std::byte> message) const noexcept {
  return Walk(*this, message, nullptr).message(0);
}

std::string MessageBounds::broken_by(std::span<const std::byte> message) const {
  std::string why;
  Walk(*this, message, &why).message(0);
  return why;
}

}  // namespace segue::ros2
