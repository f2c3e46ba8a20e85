// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/seats.hpp>

#include <segue/host/full_id.hpp>

#include <gmock/gmock.h>

namespace segue::deploy::detail {
namespace {

using model::DeploymentKey;
using model::TaskId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const TaskId kTask("b");

DeploymentKey process(std::string_view name) {
  return {model::kLocalHost, model::ProcessName(name)};
}

TaskId at(std::string_view name) {
  return host::full_id(kTask, process(name));
}

/// Where an id leads; "" where nowhere.
std::string where(const Seats& seats, const TaskId& id, Which which) {
  const auto place = seats.find(id, which);
  return place ? place->process.process.str() : std::string();
}

/// b stands in p, and has been made in q.
void move(Seats& seats) {
  seats.put({kTask, process("p")});
  seats.put({kTask, process("q")});
}

TEST(FullId, comes_apart_as_it_was_put_together) {
  const auto split = host::split_id(at("q"));
  EXPECT_EQ(at("q").str(), "b@localhost/q");
  EXPECT_EQ(split.task, kTask);
  EXPECT_EQ(split.process, process("q"));
  EXPECT_EQ(host::split_id(kTask).process, std::nullopt);
  EXPECT_EQ(host::split_id(TaskId("b@x")).task, TaskId("b@x"))
      << "without a process it is a name like others";
  const auto own = host::split_id(host::full_id(kTask, DeploymentKey{}));
  ASSERT_TRUE(own.process);
  EXPECT_TRUE(own.process->is_runtime());
}

TEST(Seats, a_task_in_one_process_is_what_its_plain_id_and_its_full_id_mean) {
  Seats seats;
  seats.put({kTask, process("p")});
  for (const Which which : {Which::Standing, Which::Newest}) {
    EXPECT_EQ(where(seats, kTask, which), "p");
    EXPECT_EQ(where(seats, at("p"), which), "p");
    EXPECT_EQ(where(seats, at("q"), which), "");
  }
  EXPECT_EQ(seats.name(kTask, process("p")), kTask);
}

TEST(Seats, while_it_moves_the_one_that_stands_has_the_plain_id) {
  Seats seats;
  move(seats);
  EXPECT_EQ(where(seats, kTask, Which::Standing), "p");
  EXPECT_EQ(where(seats, kTask, Which::Newest), "q");
  EXPECT_EQ(where(seats, at("p"), Which::Newest), "p") << "a full id means exactly that one";
  EXPECT_EQ(where(seats, at("q"), Which::Standing), "q");
  EXPECT_EQ(seats.name(kTask, process("p")), kTask);
  EXPECT_EQ(seats.name(kTask, process("q")), at("q"));
}

TEST(Seats, when_it_has_moved_the_new_one_has_the_plain_id) {
  Seats seats;
  move(seats);
  EXPECT_THAT(seats.conclude(), ElementsAre(Seats::Place{kTask, process("p")}));
  EXPECT_EQ(where(seats, kTask, Which::Standing), "q");
  EXPECT_EQ(seats.name(kTask, process("p")), at("p")) << "until it is forgotten";
  seats.drop({kTask, process("p")});
  EXPECT_EQ(where(seats, at("p"), Which::Standing), "");
  EXPECT_THAT(seats.conclude(), IsEmpty());
}

TEST(Seats, given_up_the_new_one_keeps_its_full_id) {
  Seats seats;
  move(seats);
  seats.withdraw();
  EXPECT_EQ(where(seats, kTask, Which::Newest), "p");
  EXPECT_EQ(seats.name(kTask, process("q")), at("q"));
  EXPECT_FALSE(seats.free_place(kTask, process("q"))) << "it has to go before it is made anew";
  EXPECT_TRUE(seats.free_place(at("q"), process("q"))) << "unless just that one is meant";
  EXPECT_TRUE(seats.free_place(kTask, process("r")));
  seats.drop({kTask, process("q")});
  EXPECT_TRUE(seats.free_place(kTask, process("q")));
}

TEST(Seats, nothing_takes_the_place_of_one_that_dies_while_it_moves) {
  Seats seats;
  move(seats);
  EXPECT_THAT(seats.drop(process("p")), ElementsAre(kTask));
  EXPECT_EQ(where(seats, kTask, Which::Standing), "") << "a stop of the old one must not stop the new one";
  EXPECT_EQ(where(seats, kTask, Which::Newest), "q");
  EXPECT_EQ(seats.name(kTask, process("q")), at("q"));
  seats.withdraw();
  EXPECT_EQ(where(seats, kTask, Which::Standing), "q") << "the only one there is";
}

TEST(Seats, a_new_one_that_dies_leaves_the_old_one) {
  Seats seats;
  move(seats);
  EXPECT_THAT(seats.drop(process("q")), ElementsAre(at("q")));
  EXPECT_EQ(where(seats, kTask, Which::Newest), "p");
  EXPECT_THAT(seats.conclude(), IsEmpty());
}

TEST(Seats, learn_what_a_process_holds_and_what_it_holds_no_more) {
  Seats seats;
  seats.learn(process("p"), {TaskId("a"), kTask}, seats.begin_look());
  seats.learn(process("q"), {kTask}, seats.begin_look());
  EXPECT_EQ(seats.name(kTask, process("q")), at("q"));
  seats.learn(process("p"), {TaskId("a")}, seats.begin_look());
  EXPECT_EQ(seats.name(kTask, process("q")), kTask);
  EXPECT_EQ(where(seats, kTask, Which::Standing), "q");
  EXPECT_THAT(seats.drop(process("p")), ElementsAre(TaskId("a")));
  EXPECT_THAT(seats.drop(process("q")), ElementsAre(kTask));
  EXPECT_EQ(where(seats, kTask, Which::Newest), "");
}

TEST(Seats, what_a_look_shows_is_older_than_what_was_done_since_it_began) {
  Seats seats;
  seats.put({TaskId("a"), process("p")});
  auto look = seats.begin_look();
  seats.put({kTask, process("p")});
  seats.drop({TaskId("a"), process("p")});
  seats.learn(process("p"), {TaskId("a")}, look);
  EXPECT_EQ(where(seats, kTask, Which::Standing), "p");
  EXPECT_EQ(where(seats, TaskId("a"), Which::Standing), "");
  seats.learn(process("p"), {TaskId("a")}, seats.begin_look());
  EXPECT_EQ(where(seats, kTask, Which::Standing), "") << "a newer look sees what has become of it";
  EXPECT_EQ(where(seats, TaskId("a"), Which::Standing), "p");
  look = seats.begin_look();
  seats.drop(process("p"));
  seats.learn(process("p"), {TaskId("a")}, look);
  EXPECT_EQ(where(seats, TaskId("a"), Which::Standing), "") << "that process is gone";
}

TEST(Seats, one_that_a_look_saw_before_it_was_told_of_is_the_newest_all_the_same) {
  Seats seats;
  seats.put({kTask, process("p")});
  seats.learn(process("q"), {kTask}, seats.begin_look());
  seats.put({kTask, process("q")});
  EXPECT_EQ(where(seats, kTask, Which::Newest), "q");
}

TEST(Seats, the_runtimes_own_process_is_one_whatever_its_host_is_called) {
  Seats seats;
  seats.put({kTask, process("p")});
  const DeploymentKey own{model::kLocalHost, {}};
  const auto place = seats.free_place(kTask, own);
  ASSERT_TRUE(place);
  seats.put(*place);
  ASSERT_TRUE(seats.find(kTask, Which::Newest));
  EXPECT_TRUE(seats.find(kTask, Which::Newest)->process.is_runtime());
  EXPECT_TRUE(seats.find(host::full_id(kTask, own), Which::Standing));
}

}  // namespace
}  // namespace segue::deploy::detail
