// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/test_support.hpp>

namespace segue::deploy {
namespace {

/// Does what a runtime does around the commit of a transition that gives `flow_` another policy.
class CommittingDeployments : public ConnectedDeployments {
 protected:
  CommittingDeployments() {
    run_both();
    EXPECT_TRUE(connect(flow_));
    EXPECT_TRUE(arrives_after(pair::last + 10));
  }

  /// Does what actions of Prepare do.
  void prepare(const model::Connection& connection) {
    const auto origin = describe(connection);
    ASSERT_TRUE(origin);
    const std::vector<OpenInput> inputs{{connection, *origin, true}};
    const auto place = q_.deployment->open_inputs(inputs, soon()).at(0);
    ASSERT_TRUE(place) << to_string(place.error());
    const std::vector<AttachOutput> outputs{{connection, *place, true}};
    const auto attached = p_.deployment->attach_outputs(outputs, soon()).at(0);
    ASSERT_TRUE(attached) << to_string(attached.error());
  }
  /// On the page of a runtime; `ending` ends with the commit.
  std::uint64_t arm(const std::shared_ptr<sample_link::CommitPage>& page, const model::Connection& ending) {
    ArmCommit what{page, page->begin(), {}, {}};
    what.endpoints = {{ending, Side::Output, q_.memory->incarnation()}};
    EXPECT_TRUE(p_.deployment->arm_commit(what, soon()));
    what.endpoints = {{ending, Side::Input, p_.memory->incarnation()}};
    EXPECT_TRUE(q_.deployment->arm_commit(what, soon()));
    return what.number;
  }
  void settle() {
    EXPECT_TRUE(p_.deployment->settle(soon()));
    EXPECT_TRUE(q_.deployment->settle(soon()));
  }
  /// The connections that carry samples, by the size of their buffers.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> sizes;
    for (const auto& endpoint : q_.endpoints()) {
      if (endpoint.carries) sizes.push_back(endpoint.connection.policy.size);
    }
    return sizes;
  }

  const model::Connection other_ = [this] {
    auto connection = flow_;
    connection.policy.size = 32;
    return connection;
  }();
};

TEST_F(CommittingDeployments, ExchangeAConnectionBetweenTwoSamplesAgainAndAgain) {
  const auto page = *sample_link::CommitPage::create();
  for (int i = 0; i < 200; ++i) {
    const auto& old = i % 2 == 0 ? flow_ : other_;
    const auto& fresh = i % 2 == 0 ? other_ : flow_;
    prepare(fresh);
    const std::uint64_t number = arm(page, old);
    EXPECT_THAT(sizes(), ElementsAre(old.policy.size));
    page->commit(number);
    EXPECT_THAT(sizes(), ElementsAre(fresh.policy.size)) << "from the store on";
    settle();
    EXPECT_TRUE(arrives_after(pair::last));
    close(old);
  }
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, GoOnAsBeforeWhereTheRuntimeDiesBeforeTheStore) {
  prepare(other_);
  {
    const auto page = *sample_link::CommitPage::create();
    arm(page, flow_);
  }
  EXPECT_TRUE(arrives_after(pair::last + 10)) << "nobody waits for a runtime";
  settle();  // by the next runtime
  EXPECT_THAT(sizes(), ElementsAre(flow_.policy.size));
  close(other_);

  prepare(other_);  // and its own transition, whose number is the same on another page
  const auto page = *sample_link::CommitPage::create();
  const std::uint64_t number = arm(page, flow_);
  page->commit(number);
  settle();
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, HaveSwitchedWhereTheRuntimeDiesRightAfterTheStore) {
  prepare(other_);
  {
    const auto page = *sample_link::CommitPage::create();
    page->commit(arm(page, flow_));
  }
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  settle();  // by the next runtime
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
  EXPECT_TRUE(arrives_after(pair::last + 10));
  close(flow_);
  EXPECT_EQ(pair::backwards, 0);
}

TEST_F(CommittingDeployments, AreNotDisturbedByThePageOfARuntimeThatWasReplaced) {
  const auto old_page = *sample_link::CommitPage::create();
  const auto page = *sample_link::CommitPage::create();
  prepare(other_);
  const std::uint64_t number = arm(page, flow_);
  old_page->commit(number);
  EXPECT_THAT(sizes(), ElementsAre(flow_.policy.size));
  page->commit(number);
  EXPECT_THAT(sizes(), ElementsAre(other_.policy.size));
}

}  // namespace
}  // namespace segue::deploy
