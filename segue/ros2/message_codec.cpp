// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/message_codec.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/ros2/type_hash.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/made_type.hpp>
#include <segue/type/type.hpp>

#include <memory>
#include <utility>

namespace segue::ros2 {
namespace {

/// An object of a type with its default value.
std::shared_ptr<void> make_object(const type::TypeInfo& info) {
  std::unique_ptr<std::byte[]> memory(new std::byte[info.size]);
  info.construct(memory.get());
  return {memory.release(), [&info](std::byte* bytes) {
            info.destroy(bytes);
            delete[] bytes;
          }};
}

}  // namespace

Result<MessageCodec> MessageCodec::of(InterfaceLibrary& library, std::string_view name) {
  auto hash = ros2::type_hash(library, name);
  if (!hash) return hash.error();
  type::TypeRegistry registry;
  auto type = message_type(library, name, registry);
  if (!type) return type.error();
  auto defaults = message_defaults(library, name);
  if (!defaults) return defaults.error();
  auto info = type::make_type_info(**type, *defaults);
  if (!info) return info.error();
  auto bounds = MessageBounds::of(library, name);
  if (!bounds) return bounds.error();
  auto parts = parse_interface_name(name);
  if (!parts) return parts.error();
  MessageCodec codec;
  codec.info_ = *info;
  codec.name_ = to_string(*parts);
  codec.dds_type_ = dds_type_name(codec.name_);
  codec.type_hash_ = *hash;
  codec.bounds_ = std::move(*bounds);
  return codec;
}

Result<std::vector<std::byte>> MessageCodec::encode(const type::Value& value, std::string_view path) const {
  const std::shared_ptr<void> object = make_object(*info_);
  if (!value.is_null()) {
    if (auto read = info_->from_value(object.get(), value, path); !read) return read.error();
  }
  std::vector<std::byte> message(type::cdr_size(*info_, object.get()));
  if (message.empty() || !type::write_cdr(*info_, object.get(), message))
    return fail(ErrorCode::Unsupported, "a " + name_ + " that large cannot be sent");
  if (bounds_.kept_by(message)) return message;
  return fail(ErrorCode::InvalidArgument, std::string(path) + ": " + bounds_.broken_by(message));
}

Result<type::Value> MessageCodec::decode(std::span<const std::byte> message) const {
  const std::shared_ptr<void> object = make_object(*info_);
  if (type::read_cdr(*info_, object.get(), message)) return info_->to_value(object.get());
  return fail(ErrorCode::ParseError, std::to_string(message.size()) + " bytes are not a " + name_);
}

}  // namespace segue::ros2
