// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc/connection_table.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace segue::control {
namespace {

class ConnectionTableTest : public ::testing::Test {
 protected:
  using Place = ConnectionTable::Place;

  Place add(const std::string& name, const std::string& address = "10.0.0.1") {
    return table_.add(address, [this, name](const std::string&) { cut_off_.push_back(name); });
  }
  void add_strangers(std::size_t count, const std::string& address) {
    for (; count > 0; --count)
      places_.push_back(add(address, address));
  }
  void add_clients(std::size_t count, const std::string& person) {
    for (std::size_t number = 0; number < count; ++number) {
      places_.push_back(add(person + std::to_string(number)));
      EXPECT_TRUE(places_.back().enter(person));
    }
  }

  ConnectionTable table_;
  std::vector<std::string> cut_off_;  ///< names, in this order
  std::vector<Place> places_;
};

using Names = std::vector<std::string>;

TEST_F(ConnectionTableTest, OfTooManyStrangersTheOldestGoes) {
  const Place oldest = add("oldest");
  const Place second = add("second");
  add_strangers(ConnectionTable::kMostStrangers - 2, "10.0.0.1");
  EXPECT_EQ(cut_off_, Names());
  const Place one_more = add("one more");
  EXPECT_EQ(cut_off_, Names{"oldest"});
  EXPECT_TRUE(oldest.is_cut_off());
  const Place another = add("another");
  EXPECT_EQ(cut_off_, (Names{"oldest", "second"}));
}

TEST_F(ConnectionTableTest, TheAddressWithMostStrangersLosesOne) {
  const Place alone = add("alone", "10.0.0.2");
  add_strangers(ConnectionTable::kMostStrangers - 1, "10.0.0.1");
  const Place one_more = add("one more", "10.0.0.3");
  EXPECT_EQ(cut_off_, Names{"10.0.0.1"});
}

TEST_F(ConnectionTableTest, StrangersWithACertificateGoLast) {
  Place known = add("known");
  known.identify(Identity());
  add_strangers(2 * ConnectionTable::kMostStrangers, "10.0.0.1");
  EXPECT_FALSE(known.is_cut_off());
}

TEST_F(ConnectionTableTest, StrangersWithACertificateKeepNobodyOut) {
  Place oldest = add("oldest");
  oldest.identify(Identity());
  while (places_.size() < ConnectionTable::kMostStrangers - 1) {
    places_.push_back(add("others"));
    places_.back().identify(Identity());
  }
  const Place one_more = add("one more");
  EXPECT_EQ(cut_off_, Names{"oldest"});
}

TEST_F(ConnectionTableTest, ClientsAreNoStrangers) {
  add_clients(ConnectionTable::kMostClients, "ann");
  add_strangers(ConnectionTable::kMostStrangers, "10.0.0.1");
  EXPECT_EQ(cut_off_, Names());
  EXPECT_EQ(table_.clients(), ConnectionTable::kMostClients);
}

TEST_F(ConnectionTableTest, APlaceIsFreeWhereItsConnectionHasEnded) {
  add_clients(ConnectionTable::kMostClients, "ann");
  places_.pop_back();
  Place next = add("next");
  EXPECT_TRUE(next.enter("ann"));
}

TEST_F(ConnectionTableTest, WhoHasAllPlacesGetsNoMore) {
  add_clients(ConnectionTable::kMostClients, "ann");
  Place one_more = add("one more");
  EXPECT_FALSE(one_more.enter("ann"));
  EXPECT_FALSE(one_more.has_entered());
  EXPECT_EQ(cut_off_, Names());
}

TEST_F(ConnectionTableTest, WhoHasMostLosesTheNewestToWhoHasFewer) {
  add_clients(2, "ann");
  add_clients(ConnectionTable::kMostClients - 2, "bob");
  Place other = add("other");
  EXPECT_TRUE(other.enter("cat"));
  EXPECT_EQ(cut_off_, Names{"bob" + std::to_string(ConnectionTable::kMostClients - 3)});
  EXPECT_TRUE(places_.back().is_cut_off());
  EXPECT_EQ(table_.clients(), ConnectionTable::kMostClients);
}

TEST_F(ConnectionTableTest, PlacesAreNotTakenInTurns) {
  add_clients(ConnectionTable::kMostClients / 2, "ann");
  add_clients(ConnectionTable::kMostClients / 2, "bob");
  Place one_more = add("one more");
  EXPECT_FALSE(one_more.enter("ann"));
  EXPECT_EQ(cut_off_, Names());
}

TEST_F(ConnectionTableTest, WhoHasOneMoreLosesNone) {
  add_clients(ConnectionTable::kMostClients / 2 - 1, "ann");
  add_clients(ConnectionTable::kMostClients / 2, "bob");
  add_clients(1, "cat");
  Place one_more = add("one more");
  EXPECT_FALSE(one_more.enter("ann")) << "else they would take it from each other in turns";
  EXPECT_EQ(cut_off_, Names());
}

TEST_F(ConnectionTableTest, WhoHasComeInIsInOnce) {
  Place place = add("ann");
  EXPECT_TRUE(place.enter("ann"));
  EXPECT_TRUE(place.enter("ann"));
  EXPECT_EQ(table_.clients(), 1U);
}

TEST_F(ConnectionTableTest, AllOtherConnectionsOfAPersonCanBeEnded) {
  add_clients(3, "ann");
  add_clients(1, "bob");
  places_.front().cut_off_others("ann", "a test");
  EXPECT_EQ(cut_off_, (Names{"ann1", "ann2"}));
  EXPECT_EQ(table_.clients(), 2U);
}

TEST_F(ConnectionTableTest, WhoWasCutOffDoesNotComeIn) {
  Place oldest = add("oldest");
  add_strangers(ConnectionTable::kMostStrangers, "10.0.0.1");
  EXPECT_FALSE(oldest.enter("ann"));
  EXPECT_EQ(table_.clients(), 0U);
}

TEST_F(ConnectionTableTest, AConnectionThatWasHandedOnIsEndedThere) {
  Place oldest = add("before");
  oldest.hand_on([this](const std::string&) { cut_off_.emplace_back("after"); });
  const Place moved = std::move(oldest);
  add_strangers(ConnectionTable::kMostStrangers, "10.0.0.1");
  EXPECT_EQ(cut_off_, Names{"after"});
}

}  // namespace
}  // namespace segue::control
