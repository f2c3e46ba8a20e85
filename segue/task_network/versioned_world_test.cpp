// SPDX-License-Identifier: Apache-2.0
#include <segue/task_network/versioned_world.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <thread>

namespace segue::task_network {
namespace {

FactId fact(std::uint32_t number) {
  return FactId{number};
}

TEST(FactTable, KnowsAFactHoweverItIsWritten) {
  FactTable table;
  EXPECT_EQ(*table.intern("on( box1 ,table )"), *table.intern("on(box1,table)"));
  EXPECT_EQ(*table.intern("empty"), *table.intern("empty()"));
  EXPECT_EQ(table.text(*table.intern("on(a, b)")), "on(a,b)");
  EXPECT_FALSE(table.intern_literal("!on(a,b)")->value);
  EXPECT_EQ(table.find("on(c,d)"), std::nullopt);
}

TEST(FactTable, TakesNamesOfSeveralWordsWhereAskedTo) {
  FactTable table;
  const auto fact = table.intern_named("at(red box,table)");
  ASSERT_TRUE(fact);
  EXPECT_EQ(table.text(*fact), "at(red box,table)");
  EXPECT_EQ(*table.intern_named("at( red box , table )"), *fact);
  for (const char* text : {"", "p(a", "p(a(b))", "p(,)", "p q(a)", "p(a\nb)"})
    EXPECT_FALSE(table.intern_named(text)) << text;
}

TEST(FactTable, RefusesWhatIsNoFact) {
  FactTable table;
  for (const char* text : {"", "(a)", "p(", "p(a", "p(a,)", "p(,a)", "p(a))", "p q", "p(a b)", "!", "p(a)b"})
    EXPECT_FALSE(table.intern_literal(text)) << text;
}

TEST(FactTable, ChecksArgumentsAgainstDeclarations) {
  FactTable table;
  ASSERT_TRUE(table.declare_type("vehicle"));
  ASSERT_TRUE(table.declare_type("truck", "vehicle"));
  ASSERT_TRUE(table.declare_constant("t1", std::vector<std::string>{"truck"}));
  ASSERT_TRUE(table.declare_constant("box", std::vector<std::string>{"object"}));
  ASSERT_TRUE(table.declare_predicate("moves", {{"vehicle"}}));
  EXPECT_TRUE(table.intern("moves(t1)"));
  EXPECT_EQ(table.intern("moves(box)").error().code, ErrorCode::TypeMismatch);
  EXPECT_EQ(table.intern("moves(t1,t1)").error().code, ErrorCode::TypeMismatch);
  EXPECT_EQ(table.intern("moves(t2)").error().code, ErrorCode::NotFound);
  EXPECT_FALSE(table.declare_type("vehicle", "truck")) << "above itself";
  EXPECT_FALSE(table.declare_constant("t1", std::vector<std::string>{"truck"}));
  EXPECT_FALSE(table.declare_predicate("moves", {}));
}

TEST(VersionedWorld, ChangesOnlyWhereAValueChanges) {
  VersionedWorld world;
  EXPECT_TRUE(world.set({fact(3), true}));
  EXPECT_FALSE(world.set({fact(3), true}));
  EXPECT_FALSE(world.set({fact(1'000'000), false}));
  EXPECT_EQ(world.version(), 1U);
  EXPECT_EQ(world.version_of(fact(3)), 1U);
  EXPECT_EQ(world.version_of(fact(4)), 0U);
}

RC_GTEST_PROP(VersionedWorld, IsWhatANaiveOneIs, ()) {
  std::vector<VersionedWorld> worlds(1);
  std::vector<std::map<std::uint32_t, bool>> naive(1);
  const auto steps = *rc::gen::inRange(1, 200);
  for (int i = 0; i < steps; ++i) {
    const auto which = *rc::gen::inRange<std::size_t>(0, worlds.size());
    if (*rc::gen::inRange(0, 10) == 0 && worlds.size() < 10) {
      worlds.push_back(worlds[which]);
      naive.push_back(naive[which]);
      continue;
    }
    const auto number = *rc::gen::element(*rc::gen::inRange<std::uint32_t>(0, 70),
                                          *rc::gen::inRange<std::uint32_t>(0, 5'000'000));
    const bool value = *rc::gen::arbitrary<bool>();
    worlds[which].set({fact(number), value});
    naive[which][number] = value;
  }
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    std::vector<FactId> facts;
    for (const auto& [number, value] : naive[i]) {
      RC_ASSERT(worlds[i].holds(fact(number)) == value);
      if (value) facts.push_back(fact(number));
    }
    RC_ASSERT(worlds[i].facts() == facts);
    for (std::size_t j = 0; j < worlds.size(); ++j)
      RC_ASSERT((worlds[i] == worlds[j]) == (worlds[i].facts() == worlds[j].facts()));
  }
}

class Counter final : public UserData {
 public:
  [[nodiscard]] CowPtr<UserData> clone() const override { return make_cow<Counter>(*this); }
  void changed(const Literal& literal) override { sum += literal.value ? 1 : -1; }
  int sum = 0;
};

int sum_of(const VersionedWorld& world) {
  return static_cast<const Counter&>(*world.attached("count")).sum;
}

TEST(VersionedWorld, UserDataFollowsTheFactsOfItsOwnCopy) {
  VersionedWorld world;
  world.attach("count", make_cow<Counter>());
  world.set({fact(1), true});
  VersionedWorld copy = world;
  EXPECT_EQ(copy.attached("count"), world.attached("count")) << "shared until one changes";
  copy.set({fact(2), true});
  EXPECT_EQ(sum_of(world), 1);
  EXPECT_EQ(sum_of(copy), 2);
  EXPECT_EQ(world.attached("other"), nullptr);
}

TEST(VersionedWorld, SnapshotsAreReadOnOtherThreadsWhileTheWorldChanges) {
  VersionedWorld world;
  world.attach("count", make_cow<Counter>());
  std::vector<std::thread> readers;
  for (std::uint32_t i = 0; i < 200; ++i) {
    world.set({fact(i), true});
    if (i % 20 != 0) continue;
    readers.emplace_back([snapshot = world, i] {
      EXPECT_EQ(snapshot.facts().size(), i + 1);
      EXPECT_EQ(sum_of(snapshot), static_cast<int>(i) + 1);
    });
  }
  for (std::thread& reader : readers)
    reader.join();
}

TEST(NameTable, NumbersNamesInTheOrderTheyComeAndFindsThemAgain) {
  NameTable names;
  EXPECT_FALSE(names.find("n0"));
  for (std::uint32_t i = 0; i < 5000; ++i)
    ASSERT_EQ(names.intern("n" + std::to_string(i)), i);
  const NameTable copy = names;
  const std::string* where = &names.name(0);
  EXPECT_EQ(names.intern(""), 5000U) << "an empty name is one, too";
  for (std::uint32_t i = 0; i < 5000; ++i) {
    ASSERT_EQ(names.intern("n" + std::to_string(i)), i);
    ASSERT_EQ(copy.find("n" + std::to_string(i)), i);
  }
  EXPECT_EQ(&names.name(0), where);
  EXPECT_EQ(names.size(), 5001U);
  EXPECT_EQ(copy.size(), 5000U);
  EXPECT_FALSE(copy.find(""));
}

}  // namespace
}  // namespace segue::task_network
