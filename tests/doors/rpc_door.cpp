// SPDX-License-Identifier: Apache-2.0
#include <doors/rpc_door.hpp>

#include <segue/rpc_codecs/host.capnp.h>
#include <segue/rpc_codecs/processes.capnp.h>
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/rpc/detail/rpc_channel.hpp>

#include <capnp/dynamic.h>
#include <capnp/schema.h>

#include <utility>

namespace segue::doors {

namespace {

using capnp::DynamicCapability;
using capnp::DynamicList;
using capnp::DynamicStruct;
using capnp::DynamicValue;
using control::detail::RpcChannel;

constexpr int kDeepest = 6;

capnp::InterfaceSchema schema_of(std::string_view kind) {
  if (kind == "robot") return capnp::Schema::from<control::wire::Robot>();
  if (kind == "host") return capnp::Schema::from<control::wire::Host>();
  return capnp::Schema::from<control::wire::Processes>();
}

/// Fills what is asked with hostile values, by the schema.
class Filling {
 public:
  explicit Filling(HostileValues& values) : values_(values) {}

  void fill(DynamicStruct::Builder builder, int depth) {
    const auto schema = builder.getSchema();
    for (const auto field : schema.getNonUnionFields())
      fill(builder, field, depth);
    const auto options = schema.getUnionFields();
    if (options.size() > 0)
      fill(builder, options[static_cast<unsigned>(values_.below(options.size()))], depth);
  }

 private:
  using Type = capnp::schema::Type;

  void fill(DynamicStruct::Builder builder, capnp::StructSchema::Field field, int depth) {
    if (values_.below(10) == 0) return;  // as it is where nothing is said
    if (field.getProto().isGroup()) return fill(builder.init(field).as<DynamicStruct>(), depth);
    const auto type = field.getType();
    if (type.isStruct()) {
      if (depth > 0) fill(builder.init(field).as<DynamicStruct>(), depth - 1);
    } else if (type.isList()) {
      fill_list(builder, field, depth);
    } else if (type.isText()) {
      builder.set(field, capnp::Text::Reader(without_end(values_.text()).c_str()));
    } else if (type.isData()) {
      const std::string text = values_.text();
      builder.set(field, capnp::Data::Reader(reinterpret_cast<const kj::byte*>(text.data()), text.size()));
    } else {
      fill_scalar(builder, field, type);
    }
  }

  void fill_scalar(DynamicStruct::Builder builder, capnp::StructSchema::Field field, capnp::Type type) {
    const std::string_view name = field.getProto().getName().cStr();
    switch (type.which()) {
      case Type::BOOL:
        return builder.set(field, values_.flag());
      case Type::FLOAT64:
        return builder.set(field, values_.number());
      case Type::INT64:
        // Whoever asks for it may wait for hours.
        return builder.set(field, name == "timeout" || name == "wait" ? -(values_.integer() % 1'000'000)
                                                                      : values_.integer());
      case Type::UINT64:
        return builder.set(field, static_cast<std::uint64_t>(values_.integer()));
      case Type::UINT32:
        return builder.set(field, static_cast<std::uint32_t>(values_.integer()));
      case Type::INT32:
        return builder.set(field, static_cast<std::int32_t>(values_.integer()));
      case Type::UINT8:
        return builder.set(field, static_cast<std::uint8_t>(values_.integer()));
      default:
        return;  // a capability: none is given
    }
  }

  void fill_list(DynamicStruct::Builder builder, capnp::StructSchema::Field field, int depth) {
    const auto element = field.getType().asList().getElementType();
    const auto count = static_cast<unsigned>(depth > 0 ? values_.below(4) : 0);
    const auto list = builder.init(field, count).as<DynamicList>();
    for (unsigned i = 0; i < count; ++i) {
      auto items = list;
      if (element.isStruct()) fill(items[i].as<DynamicStruct>(), depth - 1);
      if (element.isText()) items.set(i, capnp::Text::Reader(without_end(values_.text()).c_str()));
      if (element.isInt64()) items.set(i, values_.integer());
      if (element.isFloat64()) items.set(i, values_.number());
    }
  }

  /// A text of the schema has no zeros.
  static std::string without_end(std::string text) {
    std::erase(text, '\0');
    return text;
  }

  HostileValues& values_;
};

/// What an answer says.
class Reading {
 public:
  explicit Reading(Answer& answer) : answer_(answer) {}

  void read(DynamicStruct::Reader reader) {
    for (const auto field : reader.getSchema().getNonUnionFields())
      read(reader, field);
    KJ_IF_MAYBE (chosen, reader.which()) {
      read(reader, *chosen);
    }
  }
  std::vector<DynamicCapability::Client> capabilities;

 private:
  void read(DynamicStruct::Reader reader, capnp::StructSchema::Field field) {
    if (!reader.has(field)) return;
    const bool is_error = field.getType().isStruct() && field.getProto().getName() == "error";
    if (is_error && answer_.code.empty())
      answer_.code = reader.get(field).as<DynamicStruct>().get("code").as<capnp::Text>().cStr();
    read(reader.get(field));
  }
  void read(DynamicValue::Reader value) {
    switch (value.getType()) {
      case DynamicValue::TEXT:
        answer_.text += std::string(value.as<capnp::Text>().cStr()) + "\n";
        break;
      case DynamicValue::DATA: {
        const auto bytes = value.as<capnp::Data>();
        answer_.text += std::string(reinterpret_cast<const char*>(bytes.begin()), bytes.size()) + "\n";
        break;
      }
      case DynamicValue::LIST:
        for (const auto item : value.as<DynamicList>())
          read(item);
        break;
      case DynamicValue::STRUCT:
        read(value.as<DynamicStruct>());
        break;
      case DynamicValue::CAPABILITY:
        capabilities.push_back(value.as<DynamicCapability>());
        break;
      default:
        break;
    }
  }

  Answer& answer_;
};

kj::Promise<Answer> ask(DynamicCapability::Client service, capnp::InterfaceSchema::Method method,
                        HostileValues& values, int depth) {
  auto request = service.newRequest(method);
  Filling(values).fill(request, kDeepest);
  return request.send().then(
      [&values, depth](capnp::Response<DynamicStruct>&& response) -> kj::Promise<Answer> {
        Answer answer;
        Reading reading(answer);
        reading.read(response);
        kj::Promise<Answer> last = kj::mv(answer);
        for (DynamicCapability::Client& capability : reading.capabilities) {
          for (const auto next : capability.getSchema().getMethods()) {
            if (depth == 0) continue;
            last = last.then([capability, next, &values, depth](Answer&& before) mutable {
              return ask(capability, next, values, depth - 1)
                  .then([before = std::move(before)](Answer&& more) mutable {
                    before.text += more.text;
                    return std::move(before);
                  });
            });
          }
        }
        return last;
      });
}

DynamicCapability::Client service_of(RpcChannel::Connection& connection, std::string_view kind) {
  if (kind == "robot") return connection.as<control::wire::Robot>();
  if (kind == "host") return connection.as<control::wire::Host>();
  return connection.as<control::wire::Processes>();
}

}  // namespace

Result<RpcDoor> RpcDoor::open(const control::TcpEndpoint& endpoint, std::string_view kind) {
  auto channel = RpcChannel::open(endpoint, {kind, kind}, "the " + std::string(kind), kAnswerTime);
  if (!channel) return channel.error();
  return RpcDoor(std::move(*channel), std::string(kind));
}

std::vector<std::string> RpcDoor::functions() const {
  std::vector<std::string> names;
  for (const auto method : schema_of(kind_).getMethods())
    names.emplace_back(method.getProto().getName().cStr());
  return names;
}

Result<Answer> RpcDoor::call(const std::string& function, HostileValues& values) {
  const auto method = schema_of(kind_).getMethodByName(function.c_str());
  return channel_->ask<Answer>(kAnswerTime, [&](RpcChannel::Connection& connection) {
    return ask(service_of(connection, kind_), method, values, 1).then([](Answer&& answer) {
      return Result<Answer>(std::move(answer));
    });
  });
}

}  // namespace segue::doors
