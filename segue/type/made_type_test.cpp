// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr_object.hpp>
#include <segue/type/describe.hpp>
#include <segue/type/flat.hpp>
#include <segue/type/made_type.hpp>
#include <segue/type/memory_layout.hpp>

#include <gmock/gmock.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace made {

struct Point {
  float x = 0;
  double y = 0;
  std::uint8_t z = 0;
};
SEGUE_TYPE(Point, x, y, z)

struct Cloud {
  std::string frame;
  std::vector<Point> points;
  std::array<Point, 2> corners{};
  std::vector<std::string> names;
  std::vector<bool> bits;
  std::vector<std::vector<std::int32_t>> rows;
};
SEGUE_TYPE(Cloud, frame, points, corners, names, bits, rows)

}  // namespace made

namespace segue::type {
namespace {

using ::testing::HasSubstr;

/// An object of a type.
class Object {
 public:
  explicit Object(const TypeInfo& info)
      : info_(info), memory_(static_cast<std::byte*>(::operator new(info.size))) {
    info.construct(memory_);
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  ~Object() {
    info_.destroy(memory_);
    ::operator delete(memory_);
  }
  [[nodiscard]] void* get() const { return memory_; }
  [[nodiscard]] Value value() const { return info_.to_value(memory_); }
  void set(const Value& value) {
    const auto done = info_.from_value(memory_, value, "");
    EXPECT_TRUE(done) << to_string(done.error());
  }

 private:
  const TypeInfo& info_;
  std::byte* memory_;
};

/// The structure of a C++ type under other names, so that it is made anew.
const TypeInfo& made_like(const Type& type, TypeRegistry& registry,
                          const std::map<std::string, Value>& defaults = {}) {
  const auto rename = [&](const Type& one, const auto& self) -> const Type* {
    if (one.kind == TypeKind::Array) {
      const Type* item = self(*one.element, self);
      return registry.find(item->name + "[" + std::to_string(one.count) + "]");
    }
    if (one.kind == TypeKind::Container && !one.is_string())
      return registry.find("/std/vector<" + self(*one.element, self)->name + ">");
    if (one.kind != TypeKind::Compound) return registry.find(one.name);
    std::vector<std::pair<std::string, const Type*>> members;
    for (const Field& field : one.fields)
      members.emplace_back(field.name, self(*field.type, self));
    return *registry.add(*make_compound("/at_run_time" + one.name, std::move(members)));
  };
  const auto made = make_type_info(*rename(type, rename), defaults);
  EXPECT_TRUE(made) << to_string(made.error());
  return **made;
}

Value cloud() {
  const auto point = [](double x, double y, int z) { return Value::map({{"x", x}, {"y", y}, {"z", z}}); };
  return Value::map({{"frame", "a frame with a name longer than short texts are"},
                     {"points", Value::list({point(1, 2, 3), point(4, 5, 6), point(7, 8, 9)})},
                     {"corners", Value::list({point(1, 1, 1), point(2, 2, 2)})},
                     {"names", Value::list({"a", "another name that is longer than short texts"})},
                     {"bits", Value::list({true, false, true})},
                     {"rows", Value::list({Value::list({1, 2}), Value::list({}), Value::list({3})})}});
}

TEST(MadeType, IsLikeTheDescribedTypeOfTheSameMembers) {
  TypeRegistry registry;
  for (const TypeInfo* described : {&type_info<made::Point>(), &type_info<made::Cloud>()}) {
    const TypeInfo& info = made_like(*described->type, registry);
    EXPECT_NE(&info, described);
    EXPECT_EQ(info.hash, described->hash);
    EXPECT_EQ(info.size, described->size);
    EXPECT_EQ(info.alignment, described->alignment);
    EXPECT_EQ(info.trivially_copyable, described->trivially_copyable);
    EXPECT_EQ(Object(info).value(), Object(*described).value());
  }
}

TEST(MadeType, HoldsValues) {
  TypeRegistry registry;
  const TypeInfo& info = made_like(*type_info<made::Cloud>().type, registry);
  Object object(info);
  object.set(cloud());
  EXPECT_EQ(object.value(), cloud());
  Object copy(info);
  info.copy(copy.get(), object.get());
  info.copy(copy.get(), object.get());
  EXPECT_EQ(copy.value(), cloud());
  object.set(Value::map({{"points", Value::list({})}, {"names", Value::list({"b"})}}));
  EXPECT_EQ(object.value().find("points")->as_list().size(), 0U);
  EXPECT_EQ(copy.value(), cloud()) << "it has items of its own";
  const auto refused = info.from_value(copy.get(), Value::map({{"points", 3}}), "cloud");
  ASSERT_FALSE(refused);
  EXPECT_THAT(to_string(refused.error()), HasSubstr("cloud.points"));
  EXPECT_EQ(copy.value(), cloud());
}

TEST(MadeType, LiesInMemoryAsTheStruct) {
  TypeRegistry registry;
  const TypeInfo& info = made_like(*type_info<made::Cloud>().type, registry);
  Object object(info);
  object.set(cloud());
  auto& as_struct = *static_cast<made::Cloud*>(object.get());
  ASSERT_EQ(as_struct.points.size(), 3U);
  EXPECT_EQ(as_struct.points[2].y, 8);
  EXPECT_EQ(as_struct.names[1], "another name that is longer than short texts");
  for (int i = 0; i < 100; ++i)
    as_struct.points.push_back({1, 2, 3});
  as_struct.rows.insert(as_struct.rows.begin(), {9, 8});
  EXPECT_EQ(object.value().find("points")->as_list().size(), 103U);
  EXPECT_EQ(object.value().find("rows")->as_list().at(0), Value::list({9, 8}));
  object.set(cloud());
  EXPECT_EQ(as_struct.points.size(), 3U);
}

TEST(MadeType, TravelsAsTheDescribedTypeDoes) {
  TypeRegistry registry;
  const TypeInfo& described = type_info<made::Cloud>();
  const TypeInfo& info = made_like(*described.type, registry);
  made::Cloud original;
  ASSERT_TRUE(described.from_value(&original, cloud(), ""));
  ASSERT_TRUE(can_encode_cdr(info));
  std::vector<std::byte> bytes(cdr_size(described, &original));
  ASSERT_TRUE(write_cdr(described, &original, bytes));
  Object received(info);
  ASSERT_TRUE(read_cdr(info, received.get(), bytes));
  EXPECT_EQ(received.value(), cloud());
  std::vector<std::byte> again(cdr_size(info, received.get()));
  ASSERT_TRUE(write_cdr(info, received.get(), again));
  EXPECT_EQ(again, bytes);
}

TEST(MadeType, HasDefaults) {
  TypeRegistry registry;
  Type quaternion = *make_compound("/at_run_time/Quaternion",
                                   {{"x", registry.find("/double")}, {"w", registry.find("/double")}});
  const Type* part = *registry.add(std::move(quaternion));
  const Type* whole = *registry.add(
      *make_compound("/at_run_time/Pose", {{"turn", part}, {"name", registry.find("/std/string")}}));
  const auto info = make_type_info(*whole, {{"/at_run_time/Quaternion", Value::map({{"w", 1.0}})}});
  ASSERT_TRUE(info) << to_string(info.error());
  EXPECT_EQ(Object(**info).value(),
            Value::map({{"turn", Value::map({{"x", 0.0}, {"w", 1.0}})}, {"name", ""}}));
}

TEST(MadeType, IsThatWhichTheProcessHas) {
  EXPECT_EQ(*make_type_info(*type_info<made::Point>().type), &type_info<made::Point>());
  EXPECT_EQ(*make_type_info(*type_info<double>().type), &type_info<double>());
  TypeRegistry registry;
  const auto other = make_type_info(*make_compound("/made/Point", {{"x", registry.find("/double")}}));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::TypeMismatch);
  EXPECT_THAT(to_string(other.error()), HasSubstr("this process has another type '/made/Point'"));
}

TEST(MadeType, IsRefusedWhereObjectsCannotBeMade) {
  TypeRegistry registry;
  const auto refused = [&](const Type& type) { return to_string(make_type_info(type).error()); };
  EXPECT_THAT(refused(*registry.find("/double*")), HasSubstr("it is not a struct, number"));
  EXPECT_THAT(refused(*registry.find("/std/optional</uint16_t>")), HasSubstr("it is not a vector"));
  Type shifted = *make_compound("/at_run_time/Shifted", {{"a", registry.find("/double")}});
  shifted.fields[0].offset = 4;
  EXPECT_THAT(refused(shifted), HasSubstr("'a' does not lie as C++ would place it"));
  auto node = std::make_unique<Type>();
  node->kind = TypeKind::Compound;
  node->name = "/at_run_time/Node";
  auto list = std::make_unique<Type>();
  list->kind = TypeKind::Container;
  list->container_kind = "/std/vector";
  list->name = "/std/vector</at_run_time/Node>";
  list->element = node.get();
  node->fields.push_back({"next", list.get(), 0});
  EXPECT_THAT(refused(*node), HasSubstr("it contains itself"));
}

}  // namespace
}  // namespace segue::type
